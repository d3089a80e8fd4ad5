//! Doubts about a library, which a user is told before its recordings are used.

use std::path::Path;

use super::Library;
use crate::LoadError;
use crate::examiner::finding::grouped;
use execution::printable::printable;

impl Library {
    /// Refuses a library in which no recording is left.
    pub fn not_empty(&self, path: &Path) -> Result<(), LoadError> {
        match self.skipped.first() {
            Some(first) if self.recordings.is_empty() => Err(LoadError::NoneLeft {
                path: path.to_owned(),
                skipped: self.skipped.len(),
                first: first.line(),
            }),
            _ => Ok(()),
        }
    }

    /// Sentences on the files that were left out and on the doubts about the recordings, equal findings in one.
    pub fn doubts(&self) -> Vec<String> {
        let left_out = self.skipped.first().map(|first| {
            let count = self.skipped.len();
            let first = first.line();
            format!(
                "files left out: {count} (`myointent data inspect` lists them); the first: {first}"
            )
        });
        let findings = grouped(self.findings());
        let findings = findings.iter().map(|group| printable(&group.to_string()));
        left_out.into_iter().chain(findings).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::library::tests::folder;
    use crate::{LoadOptions, load};

    #[test]
    fn files_of_other_recorders_are_left_out_with_what_converts_them() {
        let mut edf = [&b"0       "[..], &[b' '; 2296]].concat();
        edf[184..188].copy_from_slice(b"2304");
        let folder = folder(&[("anna/1.edf", &edf[..]), ("anna/2.xdf", b"XDF:\x01\x04")]);
        let library = load(folder.path(), &LoadOptions::default()).unwrap();
        let told: Vec<String> = library.skipped.iter().map(crate::LoadError::line).collect();
        assert!(
            told[0].contains("found an EDF or BDF file: save its eight channels"),
            "{told:?}"
        );
        assert!(told[1].contains("with the package `pyxdf`"), "{told:?}");
    }

    #[test]
    fn a_library_without_a_recording_is_refused_with_the_first_damage() {
        let rows = "1,2,3,4,5,6,7,8,0\n".repeat(30) + "1,2\n";
        let folder = folder(&[("12345-1/0.txt", rows)]);
        let library = load(folder.path(), &LoadOptions::default()).unwrap();
        let error = library.not_empty(folder.path()).unwrap_err().to_string();
        assert!(error.contains("1 files are left out"), "{error}");
        let doubts = library.doubts();
        assert!(
            doubts[0].starts_with("files left out: 1 ")
                && doubts[0].contains("0.txt, line 31: expected 9"),
            "{doubts:?}"
        );
    }
}
