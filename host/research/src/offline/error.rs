//! Why windows and settings do not fit together.

/// Why windows and settings do not fit together.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum OfflineError {
    /// A hold of 0 samples.
    #[error("hold of 0 samples, at least 1 expected: use 1 for a label per sample")]
    Hold,
    /// Windows that all start at one sample.
    #[error("stride of 0 samples, at least 1 expected")]
    Stride,
    /// No class that may be a label, or more than a row has.
    #[error("{found} classes, 1 to {most} expected: check the model's class count")]
    Classes {
        /// Logits per row.
        most: usize,
        /// Classes asked for.
        found: usize,
    },
    /// The look-ahead needs older rows than the windows have.
    #[error("the look-ahead needs {expected} rows of a window, {found} are there: shorten it")]
    Rows {
        /// Rows needed.
        expected: usize,
        /// Rows there are.
        found: usize,
    },
    /// A window's logits are too few, too many or not whole rows.
    #[error(
        "{found} logits of a window, {fewest} to {most} in rows of {classes} expected: give all rows of \
         the first window and enough newest rows of the others"
    )]
    Logits {
        /// Fewest logits.
        fewest: usize,
        /// Most logits.
        most: usize,
        /// Logits per row.
        classes: usize,
        /// Logits found.
        found: usize,
    },
    /// A window ends after the recording.
    #[error(
        "the windows cover {expected} samples, the recording has {found}: give its own windows"
    )]
    Samples {
        /// Samples that the windows cover.
        expected: usize,
        /// Samples of the recording.
        found: usize,
    },
}
