//! Why runs cannot be put into one table.

use std::path::PathBuf;

use thiserror::Error;

use myointent::execution::run_folder::RunError;

/// Why a study cannot be read.
#[derive(Debug, Error)]
pub enum StudyError {
    /// A folder cannot be listed.
    #[error("{path}: expected a folder of runs")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A folder without a single run.
    #[error(
        "{path}: expected {expected} with a config.json each, found none: give the folder above them"
    )]
    NoRuns {
        /// The folder.
        path: PathBuf,
        /// The layout that is looked for.
        expected: &'static str,
    },
    /// A file of a run cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A fold that nobody has judged.
    #[error(
        "{run}: expected results.json, found none: run `myointent evaluate --run {run}`, or move the folder out of the study"
    )]
    NotJudged {
        /// The run's folder.
        run: PathBuf,
    },
    /// Results that were made before the config was changed.
    #[error(
        "{run}: config.json and results.json disagree on {subject}, who is left out in one of them only: run `myointent evaluate --run {run}` again"
    )]
    Stale {
        /// The run's folder.
        run: PathBuf,
        /// Somebody whom they disagree on.
        subject: String,
    },
    /// A subject with two roles in one fold.
    #[error(
        "{run}: {subject} is left out and yet trained on or validated with, so the numbers mean nothing: train this fold anew"
    )]
    TwoRoles {
        /// The run's folder.
        run: PathBuf,
        /// Who.
        subject: String,
    },
    /// A number that its protocol does not have.
    #[error("{run}: expected a fold of 1 to {of}, found {number}: train this fold anew")]
    NoSuchFold {
        /// The run's folder.
        run: PathBuf,
        /// The fold's number.
        number: usize,
        /// Folds of the protocol.
        of: usize,
    },
    /// Two folders of the same fold.
    #[error("{first} and {second} are both fold {number}: keep one of them in the study")]
    FoldTwice {
        /// The fold's number.
        number: usize,
        /// One folder.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// A subject that two folds leave out: it would count twice.
    #[error(
        "{subject} is left out in {first} and in {second}: expected everybody once; keep the folds of one protocol"
    )]
    LeftOutTwice {
        /// Who.
        subject: String,
        /// One fold's folder.
        first: PathBuf,
        /// The other's.
        second: PathBuf,
    },
    /// Folds that were not run with the same settings.
    #[error(
        "{first} and {second} were not run alike ({}): expected one preset and seed for all folds of a variant; train one of them anew or move it out",
        keys.join("; ")
    )]
    RunsDiffer {
        /// One fold's folder.
        first: PathBuf,
        /// The other's.
        second: PathBuf,
        /// Each key that differs, with both values.
        keys: Vec<String>,
    },
}
