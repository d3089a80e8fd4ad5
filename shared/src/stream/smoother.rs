//! From overlapping estimates to one steady label: look-ahead and hold.
//!
//! Every window gives a row of scores for each of its newest instants. The label of an instant `t`
//! waits until the window that ends `look_ahead` rows later has come, and rests on what all the
//! windows between say: either every row from `t` on ([`AggregationMode::AllRowsFrom`]) or only the row of
//! `t` itself ([`AggregationMode::SameInstant`]). A new label comes every `hold` windows.
//!
//! Time is counted in rows. A row is a sample where every sample has its own window, and a patch
//! on the device. No window is kept: an instant's sum grows with each window that may speak of it,
//! by a prefix sum of that window's rows, so a push costs `look_ahead + 1` row additions.
//!
//! Source: ReactEMG (arXiv 2506.19815) and its public code's live aggregator, which has both
//! readings; its labels are held to in `tests/golden`. Sums are f32, windows in time order, rows
//! newest first: the order is part of the meaning.

mod settings;

use crate::model::arithmetic::exp;
use crate::units::SampleIndex;

pub use settings::{AggregationMode, Likelihood, Settings, SettingsError, Weighting};

/// A label, still as a class number, with its delay in the open.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Decision {
    /// Class of the largest sum, the lowest on ties.
    pub class: usize,
    /// Newest sample of the row that the label speaks of.
    pub instant: SampleIndex,
    /// Newest sample that was known when the label was made: the window's end.
    pub known: SampleIndex,
}

/// Look-ahead and hold over rows of at most `CLASSES` scores, `ROWS` of them a window.
#[derive(Clone, PartialEq, Debug)]
pub struct Smoother<const CLASSES: usize, const ROWS: usize> {
    settings: Settings,
    classes: usize,
    /// Sums of the newest `look_ahead + 1` instants, in a ring.
    sums: [[f32; CLASSES]; ROWS],
    /// Place of the newest instant's sum.
    newest: usize,
    /// Windows since the restart, up to `look_ahead + 1`.
    seen: usize,
    /// Windows since the restart, modulo `hold`.
    phase: usize,
}

impl<const CLASSES: usize, const ROWS: usize> Smoother<CLASSES, ROWS> {
    /// A smoother before its first window, for rows of `classes` scores.
    ///
    /// # Errors
    /// Refuses a look-ahead of `ROWS` rows or more, a hold of 0, no or too many classes, rows of no
    /// samples, a weight factor that is negative or no number.
    pub fn new(settings: Settings, classes: usize) -> Result<Self, SettingsError> {
        let (Weighting::Equal { max_factor } | Weighting::Progressive { max_factor }) =
            settings.weighting;
        if settings.look_ahead >= ROWS {
            return Err(SettingsError::LookAhead {
                most: ROWS.saturating_sub(1),
                found: settings.look_ahead,
            });
        }
        if settings.hold == 0 {
            return Err(SettingsError::Hold);
        }
        if classes == 0 || classes > CLASSES {
            return Err(SettingsError::Classes {
                most: CLASSES,
                found: classes,
            });
        }
        if settings.row_samples == 0 {
            return Err(SettingsError::RowSamples);
        }
        if !(max_factor.is_finite() && max_factor >= 0.0) {
            return Err(SettingsError::MaxFactor { found: max_factor });
        }
        Ok(Self {
            settings,
            classes,
            sums: [[0.0; CLASSES]; ROWS],
            newest: 0,
            seen: 0,
            phase: 0,
        })
    }

    /// The settings it was made with.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Forgets all windows, as after a gap; the next one counts as the first.
    pub fn restart(&mut self) {
        self.seen = 0;
        self.phase = 0;
    }

    /// Takes the rows of the window that ends at sample `window_end`, newest first, and gives a
    /// label when one is due: from the window `look_ahead` after the first, every `hold` windows.
    ///
    /// Only the first `look_ahead + 1` rows and the live classes are read.
    pub fn push(
        &mut self,
        window_end: SampleIndex,
        rows: &[[f32; CLASSES]; ROWS],
    ) -> Option<Decision> {
        let depth = self.settings.look_ahead + 1;
        self.newest = (self.newest + 1) % depth;
        self.sums[self.newest] = [0.0; CLASSES];
        self.seen = depth.min(self.seen + 1);
        self.add(rows);

        let due = self.phase == 0 && self.seen == depth;
        self.phase = (self.phase + 1) % self.settings.hold;
        due.then(|| {
            let behind = self.settings.look_ahead as u32 * self.settings.row_samples;
            Decision {
                class: largest(&self.sums[(self.newest + 1) % depth][..self.classes]),
                instant: SampleIndex(window_end.0.wrapping_sub(behind)),
                known: window_end,
            }
        })
    }

    /// Adds what one window says of each instant that still waits. With rows `r` newest first, the
    /// instant `j` rows back gets, in the four combinations:
    ///
    /// ```text
    /// all rows, equal        w(j) * (r_0 + ... + r_j)
    /// all rows, progressive  w(j) * r_0 + w(j - 1) * r_1 + ... + w(0) * r_j
    /// same row, equal        w(j) * r_j
    /// same row, progressive  r_j                              w(i) = 1 + slope * i
    /// ```
    ///
    /// The second is a sum of sums: (r_0 + ... + r_j) + slope * (j * r_0 + ... + 1 * r_(j-1)).
    /// Weights are not divided out: one divisor for all classes moves no maximum.
    fn add(&mut self, rows: &[[f32; CLASSES]; ROWS]) {
        let depth = self.settings.look_ahead + 1;
        let slope = self.slope();
        let mut sum = [0.0; CLASSES];
        let mut sum_of_sums = [0.0; CLASSES];
        for (back, row) in rows.iter().enumerate().take(self.seen) {
            let row = self.scores(row);
            let weight = 1.0 + slope * back as f32;
            let waiting = &mut self.sums[(self.newest + depth - back) % depth];
            for class in 0..self.classes {
                sum_of_sums[class] += sum[class];
                sum[class] += row[class];
                waiting[class] += match (self.settings.aggregation, self.settings.weighting) {
                    (AggregationMode::AllRowsFrom, Weighting::Equal { .. }) => weight * sum[class],
                    (AggregationMode::AllRowsFrom, Weighting::Progressive { .. }) => {
                        sum[class] + slope * sum_of_sums[class]
                    }
                    (AggregationMode::SameInstant, Weighting::Equal { .. }) => weight * row[class],
                    (AggregationMode::SameInstant, Weighting::Progressive { .. }) => row[class],
                };
            }
        }
    }

    /// Growth of the weight per row. Without look-ahead there is one row, and it weighs 1.
    fn slope(&self) -> f32 {
        let (Weighting::Equal { max_factor } | Weighting::Progressive { max_factor }) =
            self.settings.weighting;
        (max_factor - 1.0) / self.settings.look_ahead.max(1) as f32
    }

    fn scores(&self, row: &[f32; CLASSES]) -> [f32; CLASSES] {
        match self.settings.likelihood {
            Likelihood::Logits => *row,
            Likelihood::Probabilities => softmax(row, self.classes),
        }
    }
}

/// Softmax over the first `classes` logits; the rest is 0.
fn softmax<const CLASSES: usize>(logits: &[f32; CLASSES], classes: usize) -> [f32; CLASSES] {
    let most = logits[largest(&logits[..classes])];
    let mut shares = [0.0; CLASSES];
    let mut total = 0.0;
    for (share, logit) in shares.iter_mut().zip(&logits[..classes]) {
        *share = exp(logit - most);
        total += *share;
    }
    shares.map(|share| share / total)
}

/// Place of the largest value, the first on ties; 0 when nothing compares.
fn largest(values: &[f32]) -> usize {
    let mut best = 0;
    for (place, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = place;
        }
    }
    best
}

#[cfg(test)]
mod tests;
