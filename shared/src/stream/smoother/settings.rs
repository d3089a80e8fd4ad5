//! Settings of the smoother, and which are refused.

use serde::{Deserialize, Serialize};

use crate::names::names;
use crate::units::{HOLD, LOOK_AHEAD, PATCH, SAMPLE_RATE_HZ};

/// Rows of a window that are summed for an instant.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AggregationMode {
    /// All rows from that instant to the window's end ("future" in the reference).
    AllRowsFrom,
    /// Only the row of that instant ("single" in the reference).
    SameInstant,
}

/// Settings of a [`Smoother`](super::Smoother). Lengths in rows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settings {
    /// Rows that are summed for an instant.
    pub aggregation: AggregationMode,
    /// Rows between an instant and the window that gives its label; 0 takes the newest row as it is.
    pub look_ahead: usize,
    /// Windows from one label to the next, counted from the first window; at least 1.
    pub hold: usize,
    /// Samples per row, at least 1.
    pub row_samples: u32,
    /// Margins that a label needs.
    pub margins: Margins,
}

impl Settings {
    /// The paper's look-ahead of 0.25 s and hold of 0.1 s, at one row a patch.
    pub const PAPER_IN_PATCHES: Self = Self {
        aggregation: AggregationMode::AllRowsFrom,
        look_ahead: LOOK_AHEAD / PATCH,
        hold: HOLD / PATCH,
        row_samples: PATCH as u32,
        margins: Margins::NONE,
    };
}

/// Margins that a label needs, in logits: the operating point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Margins {
    /// Confidence gate: by how much the mean logit of a class but relax has to exceed that of every other class for the label
    /// to become this class; to keep the label, and to become relax, the largest is enough. 0: no gate.
    pub entry: f32,
    /// Least difference of a class's mean logit to that of movement outside the vocabulary for the label to become
    /// this class; such movement ends no label. Below 0 where [`Early::caution`] adds much to it. `None`: rows have no such
    /// column behind the classes.
    pub other: Option<f32>,
    /// Margins of labels that are emitted before their look-ahead is over; `None`: every label waits.
    pub early: Option<Early>,
}

impl Margins {
    /// No margins: the largest class wins, every label waits.
    pub const NONE: Self = Self {
        entry: 0.0,
        other: None,
        early: None,
    };
}

/// Margins of early labels, in addition to the others. `entry` and `other` hold without look-ahead and fall evenly with it,
/// to 0 at the whole look-ahead.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Early {
    /// Margin of a class over the other classes.
    pub entry: f32,
    /// Margin of a class over movement outside the vocabulary.
    pub other: f32,
    /// Margin of a class over movement outside the vocabulary at any look-ahead, times the share of such movement in the last
    /// 20 s.
    pub caution: f32,
}

impl Early {
    /// Margin of relax over the classes, which falls as `entry` does.
    pub const RELAX: f32 = 1.0;
    /// Margin of relax over the classes at any look-ahead.
    pub const LEAVE: f32 = 0.5;
}

/// Time constant of the moving average behind [`Early::caution`], in samples: 20 s.
pub(super) const CAUTION: f32 = 20.0 * SAMPLE_RATE_HZ as f32;

names! {
    /// Named operating point: labels that change soon against labels that change seldom without intent. Chosen by
    /// cross-validation: docs/results.md has the curve.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Reaction {
        /// The soonest labels.
        Fast = "fast",
        /// Labels as steady as those that wait for the whole look-ahead.
        Balanced = "balanced",
        /// The fewest labels that nobody meant.
        Steady = "steady",
        /// Labels as late as those that wait for the look-ahead, for models of more classes, which are seldom sure before.
        Late = "late",
    }
}

impl Reaction {
    /// The margins, for a model that knows other movement.
    #[must_use]
    pub const fn margins(self) -> Margins {
        let [entry, other, early_entry, early_other, caution] = match self {
            Self::Fast => [1.5, -1.5, 0.0, 0.5, 8.0],
            Self::Balanced => [1.5, -1.5, 0.5, 0.5, 8.0],
            Self::Steady => [2.0, 0.0, 0.5, 0.5, 4.0],
            Self::Late => [1.0, -1.5, 9.0, 0.0, 8.0],
        };
        Margins {
            entry,
            other: Some(other),
            early: Some(Early {
                entry: early_entry,
                other: early_other,
                caution,
            }),
        }
    }
}

/// Operating point in place of the one in [`Settings`]; `None`: as in the settings.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Gate {
    /// [`Margins::entry`], in hundredths of a logit.
    pub entry: Option<i16>,
    /// [`Margins::other`], in hundredths. It has no effect where rows have no such column.
    pub other: Option<i16>,
    /// All margins at once; `entry` and `other` come before its own.
    pub reaction: Option<Reaction>,
}

impl Gate {
    /// The margins in force, `own` those of the settings.
    pub(super) fn over(self, own: Margins) -> Margins {
        let base = self.reaction.map_or(own, Reaction::margins);
        let logits = |hundredths: i16| f32::from(hundredths) / 100.0;
        Margins {
            entry: self.entry.map_or(base.entry, logits),
            other: own.other.and(self.other.map(logits).or(base.other)),
            early: base.early,
        }
    }
}

/// Why settings are refused.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum SettingsError {
    #[error("look-ahead of {found} rows, at most {most} fit: shorten the look-ahead")]
    LookAhead { most: usize, found: usize },
    #[error("hold of 0 rows, at least 1 expected: use 1 for a label per window")]
    Hold,
    #[error("{found} classes, 1 to {most} expected: check the model")]
    Classes { most: usize, found: usize },
    #[error("rows of 0 samples, at least 1 expected")]
    RowSamples,
}
