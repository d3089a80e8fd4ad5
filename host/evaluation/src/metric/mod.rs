//! Metrics of a predicted label sequence: a file per metric, its formula first.
//!
//! Every metric takes truth and prediction as one label per sample: none where the truth is unknown, or
//! where nothing was emitted.

pub mod balanced_accuracy;
pub mod confusion;
pub mod event;
pub mod offset;
pub mod summary;
pub mod transition;

use std::ops::Range;

use shared::intent::Intent;

use crate::EvaluationError;

/// The stretches of a truth without unlabelled samples, as long as possible.
///
/// Each is scored as a recording of its own, because the reference cuts unlabelled parts out. The
/// predictions are those of the whole recording.
fn stretches(truth: &[Option<Intent>]) -> Vec<Range<usize>> {
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

/// Number of samples up to the last one with a prediction.
///
/// With look-ahead, the last samples of a recording never get a label. The reference removes them before
/// it scores.
pub fn predicted_length(prediction: &[Option<Intent>]) -> usize {
    prediction
        .iter()
        .rposition(Option::is_some)
        .map_or(0, |last| last + 1)
}

fn by_name<S: serde::Serializer>(intent: &Intent, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(intent.name())
}

fn same_length(
    truth: &[Option<Intent>],
    prediction: &[Option<Intent>],
) -> Result<(), EvaluationError> {
    if truth.len() == prediction.len() {
        Ok(())
    } else {
        Err(EvaluationError::Length {
            truth: truth.len(),
            prediction: prediction.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_lie_between_unlabelled_samples() {
        let (r, o) = (Some(Intent::Relax), Some(Intent::Open));
        assert_eq!(stretches(&[None, r, o, None, None, o]), [1..3, 5..6]);
        assert!(stretches(&[None]).is_empty());
        assert_eq!(predicted_length(&[None, r, None]), 2);
        assert_eq!(predicted_length(&[None]), 0);
    }
}
