//! The reference's offline aggregation: labels of a whole recording from its overlapping windows.
//!
//! It is what the published figures were computed with, and kinder than a device can be: before
//! the first window ends, that window speaks of samples whose future it has seen, and a label is
//! booked at the sample it speaks of, as if the look-ahead took no time. For the honest, causal
//! form see `shared::stream::smoother`.
//!
//! One quirk of the reference is left out: there a row whose class 0 is exactly -1.0 is passed
//! over. Source: ReactEMG's public code; held to its numbers in `tests/golden`.

mod windows;

use shared::intent::Intent;
use shared::stream::smoother::AggregationMode;
use shared::units::{HOLD, LOOK_AHEAD};

pub use windows::WindowRows;

/// How rows make a label.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Vote {
    /// The largest mean logit, windows weighted linearly from 1 (first) to `max_factor` (last).
    MeanLogits {
        /// Weight of the last window.
        max_factor: f64,
    },
    /// The class that is the largest of most rows.
    Majority,
}

/// How the labels of a recording are made. Lengths in samples.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Offline {
    /// Which rows of a window speak of a sample.
    pub aggregation: AggregationMode,
    /// How rows make a label.
    pub vote: Vote,
    /// Windows that end up to this long after a sample take part in its label.
    pub look_ahead: usize,
    /// Samples that share a label; at least 1.
    pub hold: usize,
}

impl Offline {
    /// The paper's result with look-ahead; windows of stride 1.
    pub const PAPER_LOOK_AHEAD: Self = Self {
        aggregation: AggregationMode::AllRowsFrom,
        vote: Vote::MeanLogits { max_factor: 1.0 },
        look_ahead: LOOK_AHEAD,
        hold: HOLD,
    };
    /// The paper's result without look-ahead; windows of stride 20, which holds each label.
    pub const PAPER_NO_LOOK_AHEAD: Self = Self {
        aggregation: AggregationMode::SameInstant,
        vote: Vote::MeanLogits { max_factor: 1.0 },
        look_ahead: 0,
        hold: 1,
    };

    /// The class of each of `samples` samples, the best of the first `live` classes, the lowest on
    /// ties. None where nothing speaks, and over the last `look_ahead` samples, which are not to
    /// be scored.
    ///
    /// # Errors
    /// Refuses a hold of 0, no or too many live classes, windows with too few rows for the
    /// look-ahead and windows that reach beyond the recording.
    pub fn classes(
        &self,
        windows: &WindowRows,
        samples: usize,
        live: usize,
    ) -> Result<Vec<Option<usize>>, OfflineError> {
        self.check(windows, samples, live)?;
        let mut labels = vec![None; samples];
        let mut label = None;
        let judged = samples.saturating_sub(self.look_ahead);
        for from in (0..judged).step_by(self.hold) {
            label = self.class(windows, from, live).or(label);
            labels[from..judged.min(from + self.hold)].fill(label);
        }
        Ok(labels)
    }

    /// [`Offline::classes`] as intents.
    ///
    /// # Errors
    /// As there.
    pub fn intents(
        &self,
        windows: &WindowRows,
        samples: usize,
        live: usize,
    ) -> Result<Vec<Option<Intent>>, OfflineError> {
        let classes = self.classes(windows, samples, live)?;
        Ok(classes
            .into_iter()
            .map(|class| class.and_then(Intent::from_class))
            .collect())
    }

    fn check(&self, windows: &WindowRows, samples: usize, live: usize) -> Result<(), OfflineError> {
        if self.hold == 0 {
            return Err(OfflineError::Hold);
        }
        if live == 0 || live > windows.classes {
            return Err(OfflineError::Classes {
                most: windows.classes,
                found: live,
            });
        }
        if self.look_ahead >= windows.kept {
            return Err(OfflineError::Rows {
                expected: self.look_ahead + 1,
                found: windows.kept,
            });
        }
        match windows.count().checked_sub(1).map(|last| windows.end(last)) {
            Some(end) if end >= samples => Err(OfflineError::Samples {
                expected: end + 1,
                found: samples,
            }),
            _ => Ok(()),
        }
    }

    /// The class of sample `at`; none where no row speaks of it.
    fn class(&self, windows: &WindowRows, at: usize, live: usize) -> Option<usize> {
        let speaking: Vec<_> = windows
            .speaking(at, self.look_ahead)
            .map(|window| (window, self.rows(windows.end(window), at)))
            .filter(|(_, rows)| !rows.is_empty())
            .collect();
        let last = speaking.len().checked_sub(1)?;
        let mut sums = vec![0.0_f64; live];
        for (order, (window, rows)) in speaking.into_iter().enumerate() {
            for row in rows.map(|sample| &windows.row(window, sample)[..live]) {
                match self.vote {
                    Vote::Majority => sums[largest(row)] += 1.0,
                    Vote::MeanLogits { max_factor } => {
                        let late = order as f64 / last.max(1) as f64;
                        let weight = 1.0 + (max_factor - 1.0) * late;
                        for (sum, logit) in sums.iter_mut().zip(row) {
                            *sum += weight * f64::from(*logit);
                        }
                    }
                }
            }
        }
        Some(largest(&sums))
    }

    /// The samples whose rows, of a window that ends with sample `end`, speak of sample `at`.
    fn rows(&self, end: usize, at: usize) -> std::ops::Range<usize> {
        match self.aggregation {
            AggregationMode::SameInstant => at..at + 1,
            // As in the reference, the row at the look-ahead's very end is left out.
            AggregationMode::AllRowsFrom => at..(end + 1).min(at + self.look_ahead),
        }
    }
}

fn largest<T: PartialOrd>(values: &[T]) -> usize {
    (1..values.len()).fold(0, |best, place| {
        if values[place] > values[best] {
            place
        } else {
            best
        }
    })
}

/// Windows and settings that do not fit each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum OfflineError {
    /// A hold of nothing.
    #[error("hold of 0 samples, at least 1 expected: use 1 for a label per sample")]
    Hold,
    /// Windows that never move on.
    #[error("stride of 0 samples, at least 1 expected")]
    Stride,
    /// No live classes, or more than a row has.
    #[error("{found} live classes, 1 to {most} expected: check the model's class count")]
    Classes {
        /// Logits of a row.
        most: usize,
        /// Live classes asked for.
        found: usize,
    },
    /// The look-ahead reaches further back than the rows that windows have.
    #[error("the look-ahead needs {expected} rows of a window, {found} are there: shorten it")]
    Rows {
        /// Rows needed.
        expected: usize,
        /// Rows there are.
        found: usize,
    },
    /// A window's logits are too few, too many or no whole rows.
    #[error(
        "{found} logits of a window, {fewest} to {most} in rows of {classes} expected: give the \
         first window whole and enough newest rows of the others"
    )]
    Logits {
        /// Fewest logits.
        fewest: usize,
        /// Most logits.
        most: usize,
        /// Logits of a row.
        classes: usize,
        /// Logits found.
        found: usize,
    },
    /// A window reaches beyond the recording's end.
    #[error("the windows cover {expected} samples, the recording has {found}: not its windows")]
    Samples {
        /// Samples that the windows cover.
        expected: usize,
        /// Samples of the recording.
        found: usize,
    },
}

#[cfg(test)]
mod tests;
