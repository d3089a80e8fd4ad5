//! Errors of a split.

/// Why there is no such split.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum SplitError {
    /// A subject without a recording.
    #[error("expected a subject of the recordings ({known}), found {subject:?}")]
    UnknownSubject {
        /// The subject requested.
        subject: String,
        /// Names that resemble it, or how many there are.
        known: String,
    },
    /// One subject in two lists.
    #[error("{0} is both held out and for validation: take it from one list")]
    TwoRoles(String),
    /// More subjects requested than there are.
    #[error("expected at most {available} subjects of {data_set}, found a request for {wanted}")]
    TooFew {
        /// The data set.
        data_set: &'static str,
        /// Subjects that may still be chosen.
        available: usize,
        /// Subjects requested.
        wanted: usize,
    },
    /// No subject left to train on.
    #[error("no training subject is left: hold out or validate on fewer, or add recordings")]
    NothingToTrainOn,
}
