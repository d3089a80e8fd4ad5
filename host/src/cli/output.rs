//! Checks before an output file of the user's choice replaces an existing one.
//!
//! A model is never replaced. Tables and pages can be made again: a command replaces its own earlier output of that kind,
//! and no other file.

use std::fs::File;
use std::io::{self, ErrorKind, Read as _, Write};
use std::path::{Component, Path, PathBuf};

use anyhow::{bail, ensure};
use clap::Args;
use evaluation::report::Table;
use recordings::Recording;

/// Width of the tables on the terminal.
#[derive(Debug, Args)]
pub(super) struct Width {
    /// Print all tables with all columns; without it, what matters in 100 columns.
    #[arg(long)]
    pub(super) wide: bool,
}

impl Width {
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

/// Refuses the name of a file that is not replaced, if it is taken.
pub(super) fn refuse_existing(path: &Path) -> anyhow::Result<()> {
    ensure!(
        path.symlink_metadata().is_err(),
        "{} exists already: give another name with --out, or remove it",
        path.display()
    );
    Ok(())
}

/// Refuses the name of a table or a page if it is a file of another kind, which does not begin with `start`.
pub(super) fn refuse_unlike(path: &Path, start: &[u8]) -> anyhow::Result<()> {
    let first = || -> io::Result<Option<Vec<u8>>> {
        // Opening a pipe would block.
        if !path.metadata()?.is_file() {
            return Ok(None);
        }
        let mut first = Vec::new();
        File::open(path)?
            .take(start.len() as u64)
            .read_to_end(&mut first)?;
        Ok(Some(first))
    };
    match first() {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => bail!(
            "{} cannot be replaced: {error}; give another name",
            path.display()
        ),
        Ok(Some(first)) if first == start => Ok(()),
        Ok(_) => bail!(
            "{} exists already, and it is no earlier output of this command: give another name, or remove it",
            path.display()
        ),
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
    ensure!(
        parts.all(|part| matches!(part, Component::Normal(_))),
        "{name}: expected the name of a recording, found a path that leads elsewhere"
    );
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
        let assert_is_other = |path: &Path| {
            let error = refuse_unlike(path, start).unwrap_err().to_string();
            assert!(error.contains("no earlier output"), "{error}");
        };
        for other in ["", "label", "gt,emg_0\n0,1\n"] {
            std::fs::write(&path, other).unwrap();
            assert_is_other(&path);
        }
        // Neither a file, which a pipe is not either.
        assert_is_other(folder.path());
        assert!(refuse_existing(&path).is_err());
        assert!(refuse_existing(&folder.path().join("new")).is_ok());
    }
}
