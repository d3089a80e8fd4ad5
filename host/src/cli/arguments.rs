//! Arguments that several subcommands share.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use shared::stream::alignment::Arm;
use shared::uart_line::flag;

use super::output::refuse_existing;
use super::read_model;
use execution::progress;
use recordings::{Library, LoadError, LoadOptions, load_all};

/// Parses the arm for an alignment: 0 or 1 for mirrored.
pub(in crate::cli) fn mirrored(text: &str) -> Result<Arm, String> {
    let mirrored = flag(text).ok_or("0 or 1")?;
    Ok(Arm::Known { mirrored })
}

/// A model file, and one person's labelled recordings that another one is made by.
#[derive(Debug, Args)]
pub(in crate::cli) struct OwnModel {
    /// Model file to start from.
    #[arg(long, value_name = "FILE.intent")]
    pub(in crate::cli) model: PathBuf,
    /// Folder of the person's labelled recordings.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Model file to write; it must not exist.
    #[arg(long, value_name = "FILE.intent")]
    pub(in crate::cli) out: PathBuf,
    /// Person whom the new file is for, as data-set/subject or subject alone; needed if the folder has recordings of several people.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) subject: Option<String>,
    /// Refuse damaged files instead of leaving them out.
    #[arg(long)]
    strict: bool,
    #[arg(hide_short_help = true, long, help = AS_RECORDED)]
    as_recorded: bool,
}

impl OwnModel {
    pub(in crate::cli) fn read(&self) -> anyhow::Result<(Vec<u8>, Library)> {
        refuse_existing(&self.out)?;
        let bytes = read_model(&self.model)?;
        let library = recordings_of(&[&self.data], self.strict, self.as_recorded)?;
        Ok((bytes, library))
    }
}

/// Help of `--as-recorded`.
pub(in crate::cli) const AS_RECORDED: &str = "Leave the channels of published sets in their own order instead of turning them into the frame of the models \
    (docs/recordings.md, electrode frames).";

/// Loads all recordings at or below some paths, of every data set.
pub(crate) fn recordings_of(
    paths: &[impl AsRef<Path>],
    strict: bool,
    as_recorded: bool,
) -> anyhow::Result<Library> {
    let options = LoadOptions {
        strict,
        as_recorded,
        ..LoadOptions::default()
    };
    let library = load_all(paths, &options).map_err(refused)?;
    for path in paths {
        library.not_empty(path.as_ref())?;
    }
    if let Some([first, second]) = library.named_alike() {
        bail!(
            "{} and {} are both named {}: give the folder that holds both, or rename one",
            first.path.display(),
            second.path.display(),
            second.full_name()
        );
    }
    let paths: Vec<_> = paths
        .iter()
        .map(|path| path.as_ref().display().to_string())
        .collect();
    log_found(&library, &paths.join(", "));
    Ok(library)
}

/// Logs how many recordings were found, what was left out, and what is doubtful.
pub(in crate::cli) fn log_found(library: &Library, whence: &str) {
    log_doubts(library);
    let count = library.recordings.len();
    progress::log(&format!("{count} recordings in {whence}"));
    for sentence in &library.people {
        progress::log(sentence);
    }
}

/// Logs what was left out, the doubts about the recordings, and which sets are turned.
pub(in crate::cli) fn log_doubts(library: &Library) {
    if library.in_common_frame {
        for frame in library.frames() {
            progress::log(&format!("{frame} (--as-recorded leaves them)"));
        }
    }
    library
        .doubts()
        .iter()
        .for_each(|doubt| progress::log(doubt));
}

/// Message for a failed load, with the option that leaves damaged files out.
pub(crate) fn refused(error: LoadError) -> anyhow::Error {
    match error {
        LoadError::Damaged { .. } => anyhow::Error::new(error)
            .context("--strict refuses this file; without it, damaged files are left out"),
        other => other.into(),
    }
}

/// Warns that test people, who are reserved for releases, are evaluated.
pub fn warn_of_test_people(people: usize) {
    if people > 0 {
        progress::log(&format!(
            "warning: {people} test people are evaluated, who are for releases: choose nothing by their scores"
        ));
    }
}
