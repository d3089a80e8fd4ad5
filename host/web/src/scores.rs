//! Scores of the classes: the smoother's sums, computed beside the pipeline.

use std::cell::RefCell;
use std::collections::VecDeque;

use shared::calibration::{Refusal, Sums};
use shared::model::encoder::HostEncoder;
use shared::model::head::Head;
use shared::model::{Encode, LookBackLogits};
use shared::stream::smoother::{AggregationMode, Settings};
use shared::units::{LOOK_BACK, Patch};

/// Newest outputs of an encoder.
#[derive(Debug, Default)]
pub struct EncoderOutputs {
    /// Outputs that an instant's label depends on, the newest last.
    rows: VecDeque<LookBackLogits>,
    /// Whether an output came since [`EncoderOutputs::take`].
    is_new: bool,
}

impl EncoderOutputs {
    fn push(&mut self, rows: LookBackLogits) {
        if self.rows.len() == LOOK_BACK {
            self.rows.pop_front();
        }
        self.rows.push_back(rows);
        self.is_new = true;
    }

    fn clear(&mut self) {
        self.rows.clear();
        self.is_new = false;
    }

    /// Returns the probability of each of `columns` at the instant whose label is due, once for each output; none before
    /// there are as many outputs as its label depends on.
    ///
    /// It is the softmax of the mean logits: the label is the largest of the same sums, if the confidence gate lets it in.
    pub fn take(&mut self, settings: &Settings, columns: usize) -> Option<Vec<f32>> {
        let depth = settings.look_ahead + 1;
        if !std::mem::take(&mut self.is_new) || self.rows.len() < depth {
            return None;
        }
        let outputs = self.rows.range(self.rows.len() - depth..);
        let mut sums = vec![0.0; columns];
        let mut terms = 0.0;
        for (back, rows) in outputs.enumerate() {
            let summed = match settings.aggregation {
                AggregationMode::AllRowsFrom => &rows[..=back],
                AggregationMode::SameInstant => &rows[back..=back],
            };
            for row in summed {
                terms += 1.0;
                for (sum, logit) in sums.iter_mut().zip(row) {
                    *sum += logit;
                }
            }
        }
        Some(softmax(sums.iter().map(|sum| sum / terms)))
    }
}

fn softmax(logits: impl Iterator<Item = f32> + Clone) -> Vec<f32> {
    let most = logits.clone().fold(f32::NEG_INFINITY, f32::max);
    let powers: Vec<f32> = logits.map(|logit| (logit - most).exp()).collect();
    let sum: f32 = powers.iter().sum();
    powers.into_iter().map(|power| power / sum).collect()
}

/// Encoder whose outputs are kept for the scores.
#[derive(Debug)]
pub struct ObservedEncoder {
    encoder: HostEncoder<'static>,
    outputs: &'static RefCell<EncoderOutputs>,
}

impl ObservedEncoder {
    pub const fn new(
        encoder: HostEncoder<'static>,
        outputs: &'static RefCell<EncoderOutputs>,
    ) -> Self {
        Self { encoder, outputs }
    }
}

impl Encode for ObservedEncoder {
    type State = <HostEncoder<'static> as Encode>::State;

    fn classes(&self) -> usize {
        self.encoder.classes()
    }

    fn fresh(&self) -> Self::State {
        self.encoder.fresh()
    }

    fn reset(&self, state: &mut Self::State) {
        self.outputs.borrow_mut().clear();
        self.encoder.reset(state);
    }

    fn step(&self, state: &mut Self::State, patch: &Patch) -> LookBackLogits {
        let rows = self.encoder.step(state, patch);
        self.outputs.borrow_mut().push(rows);
        rows
    }

    fn hidden<'s>(&self, state: &'s Self::State) -> &'s [f32] {
        self.encoder.hidden(state)
    }

    fn logits_by(&self, head: &Head, state: &mut Self::State) -> LookBackLogits {
        self.encoder.logits_by(head, state)
    }

    fn solve(&self, sums: &Sums, state: &mut Self::State, head: &mut Head) -> Result<(), Refusal> {
        self.encoder.solve(sums, state, head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::intent::MAX_LOGITS;
    use shared::stream::smoother::Smoother;
    use shared::units::SampleIndex;

    /// Pseudo-random logits, fixed by a number.
    fn rows(number: u32) -> LookBackLogits {
        let mut state = number.wrapping_mul(2_654_435_761).wrapping_add(1);
        [(); LOOK_BACK].map(|()| {
            [(); MAX_LOGITS].map(|()| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 16) as f32 / 16_384.0
            })
        })
    }

    #[test]
    fn the_largest_score_is_the_smoothers_class() {
        for aggregation in [AggregationMode::AllRowsFrom, AggregationMode::SameInstant] {
            for look_ahead in [0, 2, 5] {
                let settings = Settings {
                    aggregation,
                    look_ahead,
                    hold: 1,
                    ..Settings::PAPER_IN_PATCHES
                };
                let mut smoother = Smoother::<MAX_LOGITS, LOOK_BACK>::new(settings, 3).unwrap();
                let mut outputs = EncoderOutputs::default();
                let mut compared = 0;
                for number in 0..50 {
                    let rows = rows(number);
                    outputs.push(rows);
                    let scores = outputs.take(&settings, 3);
                    let decision = smoother.push(SampleIndex(10 * number), &rows);
                    assert_eq!(scores.is_some(), decision.is_some(), "{number}");
                    let (Some(scores), Some(decision)) = (scores, decision) else {
                        continue;
                    };
                    let largest = scores.iter().copied().fold(0.0, f32::max);
                    assert_eq!(scores[decision.class], largest, "{number}: {scores:?}");
                    assert!((scores.iter().sum::<f32>() - 1.0).abs() < 1e-5);
                    compared += 1;
                }
                assert_eq!(compared, 50 - look_ahead);
            }
        }
    }

    #[test]
    fn an_output_gives_scores_once_and_none_after_a_reset() {
        let settings = Settings {
            look_ahead: 0,
            ..Settings::PAPER_IN_PATCHES
        };
        let mut outputs = EncoderOutputs::default();
        assert_eq!(outputs.take(&settings, 3), None);
        outputs.push(rows(1));
        assert!(outputs.take(&settings, 3).is_some());
        assert_eq!(outputs.take(&settings, 3), None);
        outputs.push(rows(2));
        outputs.clear();
        assert_eq!(outputs.take(&settings, 3), None);
    }
}
