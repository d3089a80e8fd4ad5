//! Why results cannot be put into one table.

use std::path::PathBuf;

use myointent::execution::run_folder::RunError;
use thiserror::Error;

/// Why the results of a study cannot be read.
#[derive(Debug, Error)]
pub(crate) enum ResultsError {
    /// A folder cannot be listed.
    #[error("{path}: expected a folder of runs")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A folder without any run.
    #[error(
        "{path}: expected {expected} with a config.json each, found none: give the folder above them"
    )]
    NoRuns {
        /// The folder.
        path: PathBuf,
        /// The layout that is expected.
        expected: &'static str,
    },
    /// A file of a run cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A fold without results.
    #[error(
        "{run}: expected results.json, found none: run `myointent-research evaluate --run {run}`, or move the folder out of the study"
    )]
    NotEvaluated {
        /// The run folder.
        run: PathBuf,
    },
    /// Results of a program that nobody can build again.
    #[error(
        "{run} was made by revision {revision}, whose source had changes that were not committed: commit them, build and run again, or give --allow-dirty"
    )]
    Dirty {
        /// The run folder.
        run: PathBuf,
        /// The revision.
        revision: String,
    },
    /// Results that are older than the configuration.
    #[error(
        "{run}: {subject} is held out in only one of config.json and results.json: run `myointent-research evaluate --run {run}` again"
    )]
    Stale {
        /// The run folder.
        run: PathBuf,
        /// A subject of one file only.
        subject: String,
    },
    /// A held-out subject that the models of the fold have seen.
    #[error(
        "{run}: {subject} is held out, but also used for training or validation: train this fold again"
    )]
    TwoRoles {
        /// The run folder.
        run: PathBuf,
        /// The subject.
        subject: String,
    },
    /// A fold number outside the protocol.
    #[error("{run}: expected a fold of 1 to {of}, found {number}: train this fold again")]
    NoSuchFold {
        /// The run folder.
        run: PathBuf,
        /// The fold's number.
        number: usize,
        /// Folds of the protocol.
        of: usize,
    },
    /// Two folders with one fold.
    #[error("{first} and {second} are both fold {number}: keep one of them in the study")]
    DuplicateFold {
        /// The fold's number.
        number: usize,
        /// The first folder.
        first: PathBuf,
        /// The second folder.
        second: PathBuf,
    },
    /// A subject that two folds hold out: it would count twice.
    #[error(
        "{subject} is held out in {first} and in {second}: expected every subject once; keep the folds of one protocol"
    )]
    HeldOutTwice {
        /// The subject.
        subject: String,
        /// The first fold's folder.
        first: PathBuf,
        /// The second fold's folder.
        second: PathBuf,
    },
    /// Folds with different settings.
    #[error(
        "{first} and {second} have different settings ({}): expected one preset and seed for all folds of a variant; train one of them again or move it out",
        keys.join("; ")
    )]
    RunsDiffer {
        /// The first fold's folder.
        first: PathBuf,
        /// The second fold's folder.
        second: PathBuf,
        /// Each key that differs, with both values.
        keys: Vec<String>,
    },
}
