//! How good a predicted label sequence is: one file per number, formula first.
//!
//! Every metric takes truth and prediction as one label per sample, none where nothing is known
//! (truth) or nothing was emitted (prediction).

pub mod confusion;
pub mod offset;
pub mod raw_accuracy;
pub mod summary;
pub mod transition;

use std::ops::Range;

use shared::intent::Intent;

/// Why two label sequences cannot be compared.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum MetricError {
    /// Sequences of different length.
    #[error("expected as many predicted labels as true ones ({truth}), found {prediction}")]
    Length {
        /// Labels of the truth.
        truth: usize,
        /// Labels of the prediction.
        prediction: usize,
    },
    /// A buffer without room for a change.
    #[error("expected a buffer of at least 2 samples, found {0}")]
    NarrowBuffer(usize),
    /// A true label of a single sample has no buffer of its own, so its change cannot be judged.
    #[error(
        "expected true labels of at least two samples, found one of a single sample at {at}: \
         join it to its neighbours"
    )]
    SingleSampleLabel {
        /// The sample.
        at: usize,
    },
}

/// The longest labelled stretches of a truth.
///
/// A stretch is scored as a recording of its own, as the reference cuts unlabelled parts out; the
/// predictions still come from the recording as a whole.
#[must_use]
pub fn stretches(truth: &[Option<Intent>]) -> Vec<Range<usize>> {
    let mut start = 0;
    let mut found = Vec::new();
    for chunk in truth.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let end = start + chunk.len();
        if chunk[0].is_some() {
            found.push(start..end);
        }
        start = end;
    }
    found
}

/// Samples up to the last one with a prediction.
///
/// A look-ahead leaves the last samples of a recording without a label for ever; the reference
/// cuts them off, with their truth, before it scores.
#[must_use]
pub fn predicted_length(prediction: &[Option<Intent>]) -> usize {
    prediction
        .iter()
        .rposition(Option::is_some)
        .map_or(0, |last| last + 1)
}

fn same_length(truth: &[Option<Intent>], prediction: &[Option<Intent>]) -> Result<(), MetricError> {
    if truth.len() == prediction.len() {
        Ok(())
    } else {
        Err(MetricError::Length {
            truth: truth.len(),
            prediction: prediction.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_what_lies_between_unlabelled_samples() {
        let (r, o) = (Some(Intent::Relax), Some(Intent::Open));
        assert_eq!(stretches(&[None, r, o, None, None, o]), [1..3, 5..6]);
        assert!(stretches(&[None]).is_empty());
        assert_eq!(predicted_length(&[None, r, None]), 2);
        assert_eq!(predicted_length(&[None]), 0);
    }
}
