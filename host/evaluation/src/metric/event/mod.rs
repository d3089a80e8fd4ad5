//! Event metrics: events that a user notices, counted from labels at the times at which they are emitted.
//!
//! Truth: one label a sample, from the onset of muscle activity to its end (lag-compensated labels, or labels
//! from muscle activity); none where it is unknown. Prediction: the label that a user sees at each sample,
//! look-ahead included. A file per metric; docs/metrics.md has them side by side.

pub mod activation;
pub mod decision;
pub mod flicker;
pub mod gesture;
pub mod latency;
pub mod summary;

use shared::intent::Intent;

use crate::EvaluationError;
use activation::{DailyUse, Rate};
use gesture::{Gesture, Verdict};
use recordings::DailyKind;
use recordings::movement::{Movement, MovementKind, mask};
use summary::Tally;

/// Samples before a gesture's onset, and after its end, in which a label still belongs to the gesture.
///
/// It is 0.25 s, the look-ahead: a label that is emitted that long before the onset refers to half a second before it, the
/// other side of the paper's transition buffer.
pub(crate) const TOLERANCE: usize = 50;

/// The events of one recording.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RecordingEvents {
    /// Every gesture whose onset is in the recording.
    pub gestures: Vec<Gesture>,
    /// False activations in rest.
    pub rest: Rate,
    /// Rest spans, all and kept.
    pub rests: Tally,
    /// Activations in movements outside the vocabulary.
    pub other_movement: Rate,
    /// Kind of each of these movements, and whether it raises a label.
    pub raised: Vec<(MovementKind, bool)>,
    /// Parts of daily life. They do not count as other movements.
    pub daily: Vec<(DailyKind, DailyUse)>,
    /// Label changes beyond the true ones.
    pub flicker: Rate,
}

impl RecordingEvents {
    /// Counts the events of one recording. `other_movement` are its movements outside the vocabulary, within the truth.
    ///
    /// # Errors
    /// [`EvaluationError::Length`] if the sequences differ in length.
    pub fn new(
        truth: &[Option<Intent>],
        emitted: &[Option<Intent>],
        other_movement: &[Movement],
    ) -> Result<Self, EvaluationError> {
        super::same_length(truth, emitted)?;
        let (mut others, mut raised, mut daily) = (Vec::new(), Vec::new(), Vec::new());
        for movement in other_movement {
            let samples = movement.samples.clone();
            if let MovementKind::Daily(kind) = movement.kind {
                daily.push((kind, DailyUse::of(emitted, samples)));
            } else {
                raised.push((movement.kind, activation::raises(emitted, samples)));
                others.push(movement.clone());
            }
        }
        let rest = activation::rest(truth);
        Ok(Self {
            gestures: gesture::gestures(truth, emitted),
            rests: decision::rests(emitted, &rest),
            rest: activation::activations(emitted, &rest),
            raised,
            daily,
            other_movement: activation::activations(emitted, &mask(&others, truth.len())),
            flicker: flicker::flicker(truth, emitted),
        })
    }

    /// Number of gestures that are recognised.
    pub fn recognised(&self) -> usize {
        self.gestures
            .iter()
            .filter(|gesture| gesture.verdict == Verdict::Recognised)
            .count()
    }
}

/// The label if it is one of a gesture; none if it is relax.
fn active(label: Option<Intent>) -> Option<Intent> {
    label.filter(|&intent| intent != Intent::Relax)
}

#[cfg(test)]
mod tests;
