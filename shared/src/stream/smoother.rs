//! Smooths the logits of overlapping windows to one stable label: look-ahead and hold.
//!
//! Every window gives a row of logits for each of its newest instants. The label of an instant `t` is
//! decided with the window that ends `look_ahead` rows later, by a sum over all windows between: of
//! every row from `t` on ([`AggregationMode::AllRowsFrom`]), or of the row of `t` alone
//! ([`AggregationMode::SameInstant`]). There is a new label every `hold` windows.
//!
//! Time is counted in rows. A row is a sample where every sample has a window of its own, and a patch
//! on the device. Windows are not stored: each adds its part, a prefix sum of its rows, to the sums of
//! the instants that still wait, so a push costs `look_ahead + 1` row additions.
//!
//! A confidence gate may ask for more evidence to enter a class than to stay in it ([`Margins::entry`]): where
//! the margin is not reached, the label stays, or becomes relax if relax has more than the label. After Scheme, Hudgins
//! and Englehart (IEEE Trans. Biomed. Eng. 60(6), 2013), who reject by confidence, class by class; the margin of two
//! logits is the logarithm of the ratio of their probabilities.
//!
//! An early label ([`Margins::early`]) does not wait for the whole look-ahead. At each window the means of all instants
//! that still wait are there, the newest with one row and the oldest with the whole look-ahead. The newest one that is sure
//! of another class changes the label: the fewer rows, the larger the margin that is asked. Instants up to that one are not
//! looked at again, so only later evidence changes the label back. The oldest decides as without early labels.
//!
//! Rows may have one more column, movement outside the vocabulary ([`Margins::other`]). No label comes of it: it
//! only keeps a class from being entered. A label that holds is ended by relax or another class, not by this column.
//! After such movement, as at a keyboard, a class needs a larger margin over it, after rest a smaller one
//! ([`Early::caution`]): the column's prior follows the stream, as in Saerens, Latinne and Decaestecker (Neural Computation
//! 14(1), 2002).
//!
//! Source: ReactEMG (arXiv 2506.19815) and the live aggregator of its public code, which has both
//! modes; `tests/golden` compares labels with it. Sums are f32, windows in time order, rows newest
//! first: the order is part of the definition.

mod settings;

use crate::intent::Intent;
use crate::units::SampleIndex;

use settings::CAUTION;
pub use settings::{AggregationMode, Early, Gate, Margins, Reaction, Settings, SettingsError};

/// A label as a class number, with its instant and its delay.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Decision {
    /// Class of the largest sum, the lowest on ties; or what the confidence gate leaves.
    pub class: usize,
    /// Reference time: the newest sample of the row that the label refers to.
    pub instant: SampleIndex,
    /// The window's end: the newest sample that the label depends on.
    pub window_end: SampleIndex,
}

/// Look-ahead and hold over rows of at most `CLASSES` logits, `ROWS` of them per window.
#[derive(Clone, PartialEq, Debug)]
pub struct Smoother<const CLASSES: usize, const ROWS: usize> {
    settings: Settings,
    gate: Gate,
    /// Margins in force: the settings' or the gate's.
    margins: Margins,
    classes: usize,
    /// The classes, and movement outside the vocabulary if the model knows it.
    columns: usize,
    /// Sums of the newest `look_ahead + 1` instants, in a ring.
    sums: [[f32; CLASSES]; ROWS],
    /// Index of the newest instant's sum.
    newest: usize,
    /// Windows since the restart, up to `look_ahead + 1`.
    seen: usize,
    /// Windows since a label was due, modulo `hold`: since the restart, or since an early label.
    phase: usize,
    /// Class of the newest label; relax before the first one.
    current: usize,
    /// Windows since the label changed, at most `hold`.
    held: usize,
    /// Rows from the instant at which the label changed to the newest: the instants that may change it again.
    since: usize,
    /// Moving average (EMA) over rows without a label: share in which movement outside the vocabulary has the largest logit.
    otherwise: f32,
}

/// The class of rest, which needs no evidence.
const RELAX: usize = Intent::Relax.class();

impl<const CLASSES: usize, const ROWS: usize> Smoother<CLASSES, ROWS> {
    /// A smoother before its first window, for rows of `classes` logits.
    ///
    /// # Errors
    /// Refuses a look-ahead of `ROWS` rows or more, a hold of 0, no or too many classes, rows of no
    /// samples.
    pub fn new(settings: Settings, classes: usize) -> Result<Self, SettingsError> {
        if settings.look_ahead >= ROWS {
            return Err(SettingsError::LookAhead {
                most: ROWS.saturating_sub(1),
                found: settings.look_ahead,
            });
        }
        if settings.hold == 0 {
            return Err(SettingsError::Hold);
        }
        let columns = classes + usize::from(settings.margins.other.is_some());
        if classes == 0 || columns > CLASSES {
            return Err(SettingsError::Classes {
                most: CLASSES,
                found: columns,
            });
        }
        if settings.row_samples == 0 {
            return Err(SettingsError::RowSamples);
        }
        Ok(Self {
            settings,
            gate: Gate::default(),
            margins: settings.margins,
            classes,
            columns,
            sums: [[0.0; CLASSES]; ROWS],
            newest: 0,
            seen: 0,
            phase: 0,
            current: RELAX,
            held: settings.hold,
            since: ROWS,
            otherwise: 0.0,
        })
    }

    pub(crate) const fn look_ahead(&self) -> usize {
        self.settings.look_ahead
    }

    /// Operating point in place of the settings'.
    #[must_use]
    pub const fn gate(&self) -> Gate {
        self.gate
    }

    /// Another operating point, from the next label on.
    pub fn set_gate(&mut self, gate: Gate) {
        self.gate = gate;
        self.margins = gate.over(self.settings.margins);
    }

    /// Whether rows have a column of movement outside the vocabulary.
    #[must_use]
    pub const fn knows_other(&self) -> bool {
        self.columns > self.classes
    }

    /// Forgets all windows, as after a gap: the next one is the first.
    pub fn restart(&mut self) {
        self.seen = 0;
        self.phase = 0;
        self.current = RELAX;
        self.held = self.settings.hold;
        self.since = ROWS;
        self.otherwise = 0.0;
    }

    /// Takes the rows of the window that ends at sample `window_end`, newest first. Returns a label when
    /// one is due: at every `hold`-th window, counted from the first, once `look_ahead + 1` have been
    /// taken; with early labels also when the label changes, from which the windows are then counted.
    ///
    /// Only the first `look_ahead + 1` rows and the columns of the classes, and of other movement if the settings have
    /// it, are read.
    pub fn push(
        &mut self,
        window_end: SampleIndex,
        rows: &[[f32; CLASSES]; ROWS],
    ) -> Option<Decision> {
        let depth = self.settings.look_ahead + 1;
        self.newest = (self.newest + 1) % depth;
        self.sums[self.newest] = [0.0; CLASSES];
        self.seen = depth.min(self.seen + 1);
        self.since = ROWS.min(self.since + 1);
        self.held = self.settings.hold.min(self.held + 1);
        self.add(rows);
        self.follow_other();

        let is_full = self.seen == depth;
        match self.margins.early {
            Some(early) if is_full => self.change(early),
            // After an early label of the gate before, not before an instant that has no label yet.
            None if is_full && self.phase == 0 && self.since >= depth => {
                self.current = self.gated(0.0, 0.0);
            }
            _ => {}
        }
        let due = is_full && self.phase == 0;
        self.phase = (self.phase + 1) % self.settings.hold;
        due.then(|| {
            let back = self.since.min(self.settings.look_ahead);
            let behind = back as u32 * self.settings.row_samples;
            Decision {
                class: self.current,
                instant: SampleIndex(window_end.0.wrapping_sub(behind)),
                window_end,
            }
        })
    }

    /// Updates the share of movement outside the vocabulary with the newest row, unless a label holds: a gesture is no such
    /// movement.
    fn follow_other(&mut self) {
        if self.current == RELAX && self.knows_other() {
            let sums = &self.sums[self.newest][..self.columns];
            let now = f32::from(u8::from(largest(sums) == self.classes));
            self.otherwise += (now - self.otherwise) * self.settings.row_samples as f32 / CAUTION;
        }
    }

    /// Changes the label at the newest instant that is sure of another class, unless it changed less than `hold` windows
    /// ago.
    fn change(&mut self, early: Early) {
        if self.held < self.settings.hold {
            return;
        }
        let look_ahead = self.settings.look_ahead;
        for back in 0..self.since.min(look_ahead + 1) {
            let class = if back == look_ahead {
                self.gated(Early::LEAVE, early.caution * self.otherwise)
            } else {
                self.sure(back, early)
            };
            if class != self.current {
                self.current = class;
                self.since = back;
                self.held = 0;
                self.phase = 0;
                return;
            }
        }
    }

    /// The class of the largest of the sums of the instant `back` rows before the newest if it has the margins of an early
    /// label, else the label before it.
    fn sure(&self, back: usize, early: Early) -> usize {
        let best = largest(self.sums_of(back));
        let look_ahead = self.settings.look_ahead;
        let missing = (look_ahead - back) as f32 / look_ahead as f32;
        let (beyond, leave) = if best == RELAX {
            ([Early::RELAX, 0.0], Early::LEAVE)
        } else {
            ([early.entry, early.other], 0.0)
        };
        let [from_classes, from_other] = beyond.map(|margin| margin * missing);
        let caution = early.caution * self.otherwise;
        if self.exceeds(back, best, [from_classes + leave, from_other + caution]) {
            best
        } else {
            self.current
        }
    }

    /// The class of the largest of the oldest instant's sums if the gate lets it in, else the label before it or relax.
    /// Relax has to exceed a label by `leave`, a class movement outside the vocabulary by `caution` more.
    fn gated(&self, leave: f32, caution: f32) -> usize {
        let back = self.settings.look_ahead;
        let sums = self.sums_of(back);
        let best = largest(sums);
        if best == self.current || best != RELAX && self.exceeds(back, best, [0.0, caution]) {
            best
        } else if self.current != RELAX
            && sums[self.current] > sums[RELAX] - leave * self.rows(back)
        {
            self.current
        } else {
            RELAX
        }
    }

    /// Number of rows in the sums of an instant.
    const fn rows(&self, back: usize) -> f32 {
        let windows = back + 1;
        let rows = match self.settings.aggregation {
            AggregationMode::AllRowsFrom => windows * (windows + 1) / 2,
            AggregationMode::SameInstant => windows,
        };
        rows as f32
    }

    /// The sums of the classes at the instant `back` rows before the newest.
    fn sums_of(&self, back: usize) -> &[f32] {
        &self.sums[self.place(back)][..self.classes]
    }

    /// The place of an instant's sums.
    const fn place(&self, back: usize) -> usize {
        let depth = self.settings.look_ahead + 1;
        (self.newest + depth - back) % depth
    }

    /// Whether the class `best` of an instant exceeds the other classes, and movement outside the vocabulary, by its
    /// margins and what is asked beyond them.
    fn exceeds(&self, back: usize, best: usize, beyond: [f32; 2]) -> bool {
        let sums = self.sums_of(back);
        let other = self.sums[self.place(back)][self.classes..self.columns].first();
        let margins = if best == RELAX {
            [0.0; 2]
        } else {
            [self.margins.entry, self.margins.other.unwrap_or(0.0)]
        };
        let rows = self.rows(back);
        let [from_classes, from_other] = [0, 1].map(|of| (margins[of] + beyond[of]) * rows);
        sums[best] - second(sums, best) >= from_classes
            && (best == RELAX || other.is_none_or(|other| sums[best] - other >= from_other))
    }

    /// Adds one window's rows to the sums of the instants that still wait for their label. With rows
    /// `r` newest first, the instant `j` rows back gets `r_0 + ... + r_j` ([`AllRowsFrom`]) or `r_j`
    /// ([`SameInstant`]). Sums are not divided by their number of rows: it is the same for all classes.
    ///
    /// [`AllRowsFrom`]: AggregationMode::AllRowsFrom
    /// [`SameInstant`]: AggregationMode::SameInstant
    fn add(&mut self, rows: &[[f32; CLASSES]; ROWS]) {
        let depth = self.settings.look_ahead + 1;
        let mut sum = [0.0; CLASSES];
        for (back, row) in rows.iter().enumerate().take(self.seen) {
            let waiting = &mut self.sums[(self.newest + depth - back) % depth];
            for class in 0..self.columns {
                sum[class] += row[class];
                waiting[class] += match self.settings.aggregation {
                    AggregationMode::AllRowsFrom => sum[class],
                    AggregationMode::SameInstant => row[class],
                };
            }
        }
    }
}

/// Index of the largest value, the first on ties; 0 if all comparisons fail (NaN).
fn largest(values: &[f32]) -> usize {
    let mut best = 0;
    for (place, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = place;
        }
    }
    best
}

/// The largest value but that at `best`; minus infinity if there is no other.
fn second(values: &[f32], best: usize) -> f32 {
    let others = values
        .iter()
        .enumerate()
        .filter(|(place, _)| *place != best);
    others.fold(
        f32::NEG_INFINITY,
        |most, (_, &value)| if value > most { value } else { most },
    )
}

#[cfg(test)]
mod tests;
