//! Errors of a split.

/// Why there is no such split.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum SplitError {
    /// A name that no recording bears.
    #[error(
        "{list} names {name:?}, which is no subject and no data set of these recordings; nearest: {nearest}"
    )]
    Unknown {
        /// Name of the list.
        list: &'static str,
        /// The unknown name.
        name: String,
        /// Known names that resemble it most.
        nearest: String,
    },
    /// One subject in two lists.
    #[error("{0} is listed in data.held_out and in data.validation: take it from one list")]
    TwoRoles(String),
    /// A test person listed for validation.
    #[error(
        "{0} is a test person (host/recordings/people.toml) and cannot validate: name another in data.validation"
    )]
    TestPerson(String),
    /// No subject left to train on.
    #[error("no training subject is left: hold out or validate on fewer, or add recordings")]
    NothingToTrainOn,
}
