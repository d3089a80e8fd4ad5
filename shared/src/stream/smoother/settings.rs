//! Settings of the smoother, and which are refused.

use serde::{Deserialize, Serialize};

use crate::intent::MAX_CLASSES;
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
    /// Confidence gate: by how much the mean logit of a class has to exceed that of every other class for the label to
    /// become this class; to keep the label, and to become relax, the largest is enough. By class; 0: no gate.
    pub entry_margins: [f32; MAX_CLASSES],
    /// Least difference of a class's mean logit to that of movement outside the vocabulary for the label to become
    /// this class; such movement ends no label. `None`: rows have no such column behind the classes.
    pub other_margin: Option<f32>,
    /// Margins of labels that are emitted before their look-ahead is over; `None`: every label waits.
    pub early: Option<Early>,
}

impl Settings {
    /// The paper's look-ahead of 0.25 s and hold of 0.1 s, at one row a patch.
    pub const PAPER_IN_PATCHES: Self = Self {
        aggregation: AggregationMode::AllRowsFrom,
        look_ahead: LOOK_AHEAD / PATCH,
        hold: HOLD / PATCH,
        row_samples: PATCH as u32,
        entry_margins: [0.0; MAX_CLASSES],
        other_margin: None,
        early: None,
    };
}

/// Margins of an early label, in addition to those of the settings. The first three hold without look-ahead and fall evenly
/// with it, to 0 at the whole look-ahead.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Early {
    /// Margin of a class over the other classes.
    pub entry: f32,
    /// Margin of a class over movement outside the vocabulary.
    pub other: f32,
    /// Margin of relax over the classes.
    pub relax: f32,
    /// Margin of relax over the classes at any look-ahead: the settings have no margin of relax.
    pub leave: f32,
    /// Margin of a class over movement outside the vocabulary at any look-ahead, times the share of such movement in the last
    /// 20 s.
    pub caution: f32,
}

/// Time constant of the moving average behind [`Early::caution`], in samples: 20 s.
pub(super) const CAUTION: f32 = 20.0 * SAMPLE_RATE_HZ as f32;

impl Early {
    /// The margins, in the order of the fields.
    #[must_use]
    pub const fn new([entry, other, relax, leave, caution]: [f32; 5]) -> Self {
        Self {
            entry,
            other,
            relax,
            leave,
            caution,
        }
    }

    /// The margins in the order of [`Self::new`].
    #[must_use]
    pub const fn margins(self) -> [f32; 5] {
        [self.entry, self.other, self.relax, self.leave, self.caution]
    }
}

names! {
    /// Named operating point: how soon a label changes, against how seldom it changes for nothing. Chosen by
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
    /// Margin of all classes but relax: see [`Settings::entry_margins`].
    #[must_use]
    pub const fn entry(self) -> f32 {
        match self {
            Self::Fast | Self::Balanced => 1.5,
            Self::Steady => 2.0,
            Self::Late => 1.0,
        }
    }

    /// Margin over other movement: see [`Settings::other_margin`]. Below 0 where [`Early::caution`] adds much to it.
    #[must_use]
    pub const fn other(self) -> f32 {
        match self {
            Self::Fast | Self::Balanced | Self::Late => -1.5,
            Self::Steady => 0.0,
        }
    }

    /// Margins of early labels.
    #[must_use]
    pub const fn early(self) -> Early {
        Early::new(match self {
            Self::Fast => [0.0, 0.5, 1.0, 0.5, 8.0],
            Self::Balanced => [0.5, 0.5, 1.0, 0.5, 8.0],
            Self::Steady => [0.5, 0.5, 1.0, 0.5, 4.0],
            Self::Late => [9.0, 0.0, 1.0, 0.5, 8.0],
        })
    }
}

/// Operating point in place of the one in [`Settings`]; `None`: as in the settings.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Gate {
    /// Margin of all classes, in hundredths of a logit: see [`Settings::entry_margins`].
    pub entry: Option<i16>,
    /// Margin over other movement, in hundredths: see [`Settings::other_margin`]. It has no effect where rows have no such
    /// column.
    pub other: Option<i16>,
    /// All margins at once; `entry` and `other` come before its own.
    pub reaction: Option<Reaction>,
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
