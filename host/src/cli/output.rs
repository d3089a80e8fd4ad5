//! Checks before an output file of the user's choice replaces an existing one.
//!
//! A model is never replaced. Tables and pages can be made again: a command replaces its own earlier output of that kind,
//! and no other file.

use std::fs::File;
use std::io::{self, ErrorKind, Read as _, Write};
use std::path::{Component, Path, PathBuf};

use clap::Args;
use evaluation::report::Table;
use recordings::Recording;

use thiserror::Error;

/// Width of the tables on the terminal.
#[derive(Debug, Args)]
pub(super) struct Width {
    /// Print all tables with all columns; without it, what matters in 100 columns.
    #[arg(long)]
    pub(super) wide: bool,
}

impl Width {
    /// Prints tables.
    pub(super) fn print(&self, tables: &[Table], out: &mut impl Write) -> io::Result<()> {
        for table in tables {
            writeln!(out, "{}", table.text(self.wide))?;
        }
        if !self.wide {
            writeln!(
                out,
                "--wide prints all tables and columns; the report has them too\n"
            )?;
        }
        Ok(())
    }
}

/// First bytes of a page.
pub(super) const PAGE: &[u8] = b"<!DOCTYPE html>";

/// Why a file is not written.
#[derive(Debug, Error)]
pub(super) enum OutputError {
    #[error("{} exists already: give another name with --out, or remove it", _0.display())]
    Exists(PathBuf),
    #[error(
        "{} exists already, and it is no earlier output of this command: give another name, or remove it",
        _0.display()
    )]
    Unlike(PathBuf),
    #[error("{path} cannot be replaced: {source}; give another name")]
    Unreadable {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Refuses the name of a model file if it is taken.
pub(super) fn refuse_existing(path: &Path) -> Result<(), OutputError> {
    if path.symlink_metadata().is_ok() {
        return Err(OutputError::Exists(path.to_owned()));
    }
    Ok(())
}

/// Refuses the name of a table or a page if it is a file of another kind, which does not begin with `start`.
pub(super) fn refuse_unlike(path: &Path, start: &[u8]) -> Result<(), OutputError> {
    let unreadable = |source| OutputError::Unreadable {
        path: path.to_owned(),
        source,
    };
    let unlike = || OutputError::Unlike(path.to_owned());
    match path.metadata() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(unreadable(error)),
        // Opening a pipe would block.
        Ok(found) if !found.is_file() => return Err(unlike()),
        Ok(_) => {}
    }
    let mut found = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(start.len() as u64)
        .read_to_end(&mut found)
        .map_err(unreadable)?;
    if found == start {
        Ok(())
    } else {
        Err(unlike())
    }
}

/// File of a recording in a folder with a file for each: data-set/person/name, with an ending.
pub(super) fn file_of(
    recording: &Recording,
    folder: &Path,
    ending: &str,
) -> anyhow::Result<PathBuf> {
    let name = format!("{}.{ending}", recording.full_name());
    let mut parts = Path::new(&name).components();
    if !parts.all(|part| matches!(part, Component::Normal(_))) {
        anyhow::bail!(
            "{name}: expected the name of a recording, found a path that leads elsewhere"
        );
    }
    Ok(folder.join(name))
}

/// First line of a table, which identifies its kind.
pub(super) fn first_line(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().position(|&byte| byte == b'\n');
    &bytes[..end.map_or(bytes.len(), |at| at + 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_replaces_a_table_of_its_kind_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        let start = first_line(b"label,logit_relax\n0,1\n");
        assert_eq!(start, b"label,logit_relax\n");
        refuse_unlike(&path, start).unwrap();
        std::fs::write(&path, "label,logit_relax\n2,3\n").unwrap();
        refuse_unlike(&path, start).unwrap();
        for other in ["", "label", "gt,emg_0\n0,1\n"] {
            std::fs::write(&path, other).unwrap();
            let error = refuse_unlike(&path, start).unwrap_err();
            assert!(matches!(error, OutputError::Unlike(_)), "{error}");
        }
        let error = refuse_unlike(folder.path(), start).unwrap_err();
        assert!(matches!(error, OutputError::Unlike(_)), "{error}");
        assert!(refuse_existing(&path).is_err());
        assert!(refuse_existing(&folder.path().join("new")).is_ok());
    }
}
