//! The reference's offline aggregation: labels of a whole recording from its overlapping windows.
//!
//! It is what the published figures were computed with, and kinder than a device can be: before
//! the first window ends, that window speaks of samples whose future it has seen, and a label is
//! booked at the sample it speaks of, as if the look-ahead took no time. For the honest, causal
//! form see `shared::smoother`.
//!
//! One quirk of the reference is left out: there a row whose class 0 is exactly -1.0 is passed
//! over. Source: golden/README.md, section 3.

use shared::intent::Intent;
use shared::smoother::Reading;
use shared::units::{HOLD, LOOK_AHEAD, WINDOW};

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
    pub reading: Reading,
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
        reading: Reading::AllRowsFrom,
        vote: Vote::MeanLogits { max_factor: 1.0 },
        look_ahead: LOOK_AHEAD,
        hold: HOLD,
    };
    /// The paper's result without look-ahead; windows of stride 20, which holds each label.
    pub const PAPER_NO_LOOK_AHEAD: Self = Self {
        reading: Reading::SameInstant,
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
        match windows.count.checked_sub(1).map(|last| windows.end(last)) {
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
        match self.reading {
            Reading::SameInstant => at..at + 1,
            // As in the reference, the row at the look-ahead's very end is left out.
            Reading::AllRowsFrom => at..(end + 1).min(at + self.look_ahead),
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

/// Logits of a recording's windows, which start at samples 0, `stride`, 2 `stride`, ...: of the
/// first window all rows, of the others only the newest, which are all that is ever asked for.
#[derive(Clone, PartialEq, Debug)]
pub struct WindowRows {
    classes: usize,
    stride: usize,
    /// Rows kept of every window but the first.
    kept: usize,
    count: usize,
    first: Vec<f32>,
    newest: Vec<f32>,
}

impl WindowRows {
    /// No windows yet. Rows have `classes` logits; windows will serve a look-ahead of up to
    /// `look_ahead` samples.
    ///
    /// # Errors
    /// Refuses rows of no logits, a stride of 0 and a look-ahead that no window spans.
    pub fn new(classes: usize, stride: usize, look_ahead: usize) -> Result<Self, OfflineError> {
        if classes == 0 {
            return Err(OfflineError::Classes { most: 0, found: 0 });
        }
        if stride == 0 {
            return Err(OfflineError::Stride);
        }
        if look_ahead >= WINDOW {
            return Err(OfflineError::Rows {
                expected: look_ahead + 1,
                found: WINDOW,
            });
        }
        Ok(Self {
            classes,
            stride,
            kept: look_ahead + 1,
            count: 0,
            first: Vec::new(),
            newest: Vec::new(),
        })
    }

    /// Takes the next window's logits, oldest row first: `[rows][classes]`, all 600 rows for the
    /// first window, at least `look_ahead + 1` newest rows for the others.
    ///
    /// # Errors
    /// Refuses fewer rows, more than 600, and a broken row; then nothing is taken.
    pub fn push(&mut self, logits: &[f32]) -> Result<(), OfflineError> {
        let fewest = if self.count == 0 { WINDOW } else { self.kept };
        let whole = logits.len().is_multiple_of(self.classes);
        if !whole || !(fewest..=WINDOW).contains(&(logits.len() / self.classes)) {
            return Err(OfflineError::Logits {
                fewest: fewest * self.classes,
                most: WINDOW * self.classes,
                classes: self.classes,
                found: logits.len(),
            });
        }
        if self.count == 0 {
            self.first = logits.to_vec();
        }
        self.newest
            .extend_from_slice(&logits[logits.len() - self.kept * self.classes..]);
        self.count += 1;
        Ok(())
    }

    /// Windows so far.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Last sample of a window.
    const fn end(&self, window: usize) -> usize {
        window * self.stride + WINDOW - 1
    }

    /// The windows that end with a sample of `at..=at + look_ahead`; before any ends, the first.
    fn speaking(&self, at: usize, look_ahead: usize) -> std::ops::Range<usize> {
        // Windows that end before a sample: those whose start lies before sample - 599.
        let before = |sample: usize| {
            (sample + 1)
                .saturating_sub(WINDOW)
                .div_ceil(self.stride)
                .min(self.count)
        };
        let speaking = before(at)..before(at + look_ahead + 1);
        if speaking.is_empty() && at < WINDOW {
            0..self.count.min(1)
        } else {
            speaking
        }
    }

    /// What a window says of a sample: of the first window any of its samples, of the others one
    /// of those kept.
    fn row(&self, window: usize, sample: usize) -> &[f32] {
        let (rows, row) = if window == 0 {
            (&self.first, sample)
        } else {
            let back = self.end(window) - sample;
            (&self.newest, (window + 1) * self.kept - 1 - back)
        };
        &rows[row * self.classes..][..self.classes]
    }
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
mod tests {
    use super::*;

    /// Windows of stride 1 whose every row votes for the window's own class.
    fn windows(classes: &[usize], look_ahead: usize) -> WindowRows {
        let mut windows = WindowRows::new(3, 1, look_ahead).unwrap();
        for class in classes {
            let mut row = [0.0; 3];
            row[*class] = 1.0;
            windows.push(&row.repeat(WINDOW)).unwrap();
        }
        windows
    }

    const MAJORITY: Offline = Offline {
        reading: Reading::SameInstant,
        vote: Vote::Majority,
        look_ahead: 2,
        hold: 1,
    };

    #[test]
    fn the_first_window_speaks_alone_until_others_end_within_the_look_ahead() {
        let windows = windows(&[2, 1, 1], 2);
        let labels = MAJORITY.classes(&windows, 602, 3).unwrap();
        // Sample 598: windows ending at 599, 600 vote 2 and 1, a tie; 599: 2, 1, 1.
        assert_eq!(labels[..598], [Some(2); 598]);
        assert_eq!(labels[598..], [Some(1), Some(1), None, None]);
    }

    #[test]
    fn a_later_window_can_be_given_more_weight() {
        let windows = windows(&[1, 0], 1);
        let label = |max_factor| {
            let offline = Offline {
                vote: Vote::MeanLogits { max_factor },
                look_ahead: 1,
                ..MAJORITY
            };
            offline.classes(&windows, 601, 3).unwrap()[599]
        };
        assert_eq!(label(0.5), Some(1));
        assert_eq!(label(1.5), Some(0));
    }

    #[test]
    fn a_class_that_is_not_live_is_never_a_label() {
        let windows = windows(&[2], 0);
        let offline = Offline {
            look_ahead: 0,
            ..MAJORITY
        };
        let labels = offline.intents(&windows, 600, 2).unwrap();
        assert_eq!(labels, [Some(Intent::Relax); 600]);
    }

    #[test]
    fn without_windows_nothing_is_said() {
        let windows = windows(&[], 2);
        assert_eq!(MAJORITY.classes(&windows, 3, 3), Ok(vec![None; 3]));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        assert_eq!(WindowRows::new(3, 0, 0), Err(OfflineError::Stride));
        let mut windows = windows(&[0, 0], 1);
        let refused = OfflineError::Logits {
            fewest: 6,
            most: 1800,
            classes: 3,
            found: 5,
        };
        assert_eq!(windows.push(&[0.0; 5]), Err(refused));
        let refused = OfflineError::Rows {
            expected: 3,
            found: 2,
        };
        assert_eq!(MAJORITY.classes(&windows, 601, 3), Err(refused));
        let near = Offline {
            look_ahead: 1,
            ..MAJORITY
        };
        let refused = OfflineError::Samples {
            expected: 601,
            found: 600,
        };
        assert_eq!(near.classes(&windows, 600, 3), Err(refused));
        let refused = OfflineError::Classes { most: 3, found: 4 };
        assert_eq!(near.classes(&windows, 601, 4), Err(refused));
        let held = Offline { hold: 0, ..near };
        assert_eq!(held.classes(&windows, 601, 3), Err(OfflineError::Hold));
    }
}
