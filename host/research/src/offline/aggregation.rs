//! From the logits of overlapping windows to one label per sample.

use shared::stream::smoother::AggregationMode;

use super::error::OfflineError;
use super::windows::WindowLogits;

/// How the rows that refer to a sample are combined.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Vote {
    /// The class of the largest mean logit. Windows are weighted linearly from 1 (first) to `max_factor`
    /// (last).
    MeanLogits {
        /// Weight of the last window.
        max_factor: f64,
    },
    /// The class that has the largest logit in most rows.
    Majority,
}

/// How the labels of a recording are computed. Lengths in samples.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OfflineAggregation {
    /// Which rows of a window refer to a sample.
    pub mode: AggregationMode,
    /// How these rows are combined.
    pub vote: Vote,
    /// Windows that end up to this long after a sample contribute to its label.
    pub look_ahead: usize,
    /// Consecutive samples that share a label; at least 1.
    pub hold: usize,
}

impl OfflineAggregation {
    /// The class of each of `samples` samples: the best of the first `classes` classes, the lowest on
    /// ties. None where no row refers to a sample, and for the last `look_ahead` samples, which are not
    /// scored.
    ///
    /// # Errors
    /// For a hold of 0, for 0 classes or more than a row has, for windows with fewer rows than the
    /// look-ahead needs, and for windows that end after the recording.
    pub fn labels(
        &self,
        windows: &WindowLogits,
        samples: usize,
        classes: usize,
    ) -> Result<Vec<Option<usize>>, OfflineError> {
        self.check(windows, samples, classes)?;
        let mut labels = vec![None; samples];
        let mut label = None;
        let scored = samples.saturating_sub(self.look_ahead);
        for from in (0..scored).step_by(self.hold) {
            label = self.label(windows, from, classes).or(label);
            labels[from..scored.min(from + self.hold)].fill(label);
        }
        Ok(labels)
    }

    fn check(
        &self,
        windows: &WindowLogits,
        samples: usize,
        classes: usize,
    ) -> Result<(), OfflineError> {
        if self.hold == 0 {
            return Err(OfflineError::Hold);
        }
        if classes == 0 || classes > windows.classes {
            return Err(OfflineError::Classes {
                most: windows.classes,
                found: classes,
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

    /// The class of sample `at`; none where no row refers to it.
    fn label(&self, windows: &WindowLogits, at: usize, classes: usize) -> Option<usize> {
        let contributing: Vec<_> = windows
            .contributing(at, self.look_ahead)
            .map(|window| (window, self.rows(windows.end(window), at)))
            .filter(|(_, rows)| !rows.is_empty())
            .collect();
        let last = contributing.len().checked_sub(1)?;
        let mut sums = vec![0.0_f64; classes];
        for (order, (window, rows)) in contributing.into_iter().enumerate() {
            for row in rows.map(|sample| &windows.row(window, sample)[..classes]) {
                match self.vote {
                    Vote::Majority => sums[largest(row)] += 1.0,
                    Vote::MeanLogits { max_factor } => {
                        let position = order as f64 / last.max(1) as f64;
                        let weight = 1.0 + (max_factor - 1.0) * position;
                        for (sum, logit) in sums.iter_mut().zip(row) {
                            *sum += weight * f64::from(*logit);
                        }
                    }
                }
            }
        }
        Some(largest(&sums))
    }

    /// The samples whose rows contribute to sample `at`, in a window that ends with sample `end`.
    fn rows(&self, end: usize, at: usize) -> std::ops::Range<usize> {
        match self.mode {
            AggregationMode::SameInstant => at..at + 1,
            // As in the reference, without the row at the very end of the look-ahead.
            AggregationMode::AllRowsFrom => at..(end + 1).min(at + self.look_ahead),
        }
    }
}

/// Index of the largest value, the lowest one on ties.
fn largest<T: PartialOrd>(values: &[T]) -> usize {
    (1..values.len()).fold(0, |best, index| {
        if values[index] > values[best] {
            index
        } else {
            best
        }
    })
}

#[cfg(test)]
mod tests {
    use shared::units::WINDOW;

    use super::*;

    /// Windows of stride 1; every row of a window votes for the window's own class.
    fn windows(classes: &[usize], look_ahead: usize) -> WindowLogits {
        let mut windows = WindowLogits::new(3, 1, look_ahead).unwrap();
        for class in classes {
            let mut row = [0.0; 3];
            row[*class] = 1.0;
            windows.push(&row.repeat(WINDOW)).unwrap();
        }
        windows
    }

    const MAJORITY: OfflineAggregation = OfflineAggregation {
        mode: AggregationMode::SameInstant,
        vote: Vote::Majority,
        look_ahead: 2,
        hold: 1,
    };

    #[test]
    fn the_first_window_decides_alone_until_others_end_within_the_look_ahead() {
        let windows = windows(&[2, 1, 1], 2);
        let labels = MAJORITY.labels(&windows, 602, 3).unwrap();
        // Sample 598: the windows that end at 599 and 600 vote 2 and 1, a tie; sample 599: 2, 1, 1.
        assert_eq!(labels[..598], [Some(2); 598]);
        assert_eq!(labels[598..], [Some(1), Some(1), None, None]);
    }

    #[test]
    fn a_later_window_can_be_given_more_weight() {
        let windows = windows(&[1, 0], 1);
        let label = |max_factor| {
            let offline = OfflineAggregation {
                vote: Vote::MeanLogits { max_factor },
                look_ahead: 1,
                ..MAJORITY
            };
            offline.labels(&windows, 601, 3).unwrap()[599]
        };
        assert_eq!(label(0.5), Some(1));
        assert_eq!(label(1.5), Some(0));
    }

    #[test]
    fn only_the_first_classes_can_be_labels() {
        let windows = windows(&[2], 0);
        let offline = OfflineAggregation {
            look_ahead: 0,
            ..MAJORITY
        };
        assert_eq!(offline.labels(&windows, 600, 2), Ok(vec![Some(0); 600]));
    }

    #[test]
    fn without_windows_there_are_no_labels() {
        let windows = windows(&[], 2);
        assert_eq!(MAJORITY.labels(&windows, 3, 3), Ok(vec![None; 3]));
    }

    #[test]
    fn settings_that_do_not_fit_the_windows_are_refused() {
        let windows = windows(&[0, 0], 1);
        let refused = OfflineError::Rows {
            expected: 3,
            found: 2,
        };
        assert_eq!(MAJORITY.labels(&windows, 601, 3), Err(refused));
        let short = OfflineAggregation {
            look_ahead: 1,
            ..MAJORITY
        };
        let refused = OfflineError::Samples {
            expected: 601,
            found: 600,
        };
        assert_eq!(short.labels(&windows, 600, 3), Err(refused));
        let refused = OfflineError::Classes { most: 3, found: 4 };
        assert_eq!(short.labels(&windows, 601, 4), Err(refused));
        let without_hold = OfflineAggregation { hold: 0, ..short };
        assert_eq!(
            without_hold.labels(&windows, 601, 3),
            Err(OfflineError::Hold)
        );
    }
}
