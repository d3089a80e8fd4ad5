//! What a smoother can be asked to do, and what it cannot.

use crate::units::{HOLD, LOOK_AHEAD, PATCH};

/// Which rows of a window speak of an instant.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AggregationMode {
    /// All rows from that instant to the window's end ("future" in the reference).
    AllRowsFrom,
    /// That instant's row alone ("single" in the reference).
    SameInstant,
}

/// What is summed.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Likelihood {
    /// Rows as they come.
    Logits,
    /// The softmax of each row over the live classes.
    Probabilities,
}

/// How much each row counts. A weight grows linearly from 1 to `max_factor` over the look-ahead.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Weighting {
    /// By the window's lateness: all its rows weigh the same, later windows more.
    Equal {
        /// Weight of the last window, finite and at least 0.
        max_factor: f32,
    },
    /// By the row's own distance from the instant, whatever the window.
    Progressive {
        /// Weight of the row `look_ahead` rows after the instant, finite and at least 0.
        max_factor: f32,
    },
}

/// How a [`Smoother`](super::Smoother) works. Lengths in rows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settings {
    /// Which rows speak of an instant.
    pub aggregation: AggregationMode,
    /// What is summed.
    pub likelihood: Likelihood,
    /// How much each row counts.
    pub weighting: Weighting,
    /// Rows between an instant and its label; 0 takes the newest row as it is.
    pub look_ahead: usize,
    /// Windows from one label to the next, counted from the first window; at least 1.
    pub hold: usize,
    /// Samples that a row stands for, at least 1.
    pub row_samples: u32,
}

impl Settings {
    /// The paper's look-ahead of 0.25 s and hold of 0.1 s, at one row a patch.
    pub const PAPER_IN_PATCHES: Self = Self {
        aggregation: AggregationMode::AllRowsFrom,
        likelihood: Likelihood::Logits,
        weighting: Weighting::Equal { max_factor: 1.0 },
        look_ahead: LOOK_AHEAD / PATCH,
        hold: HOLD / PATCH,
        row_samples: PATCH as u32,
    };
}

/// Settings that no smoother can have.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum SettingsError {
    /// The look-ahead needs more rows than a window gives.
    #[error("look-ahead of {found} rows, at most {most} fit: shorten the look-ahead")]
    LookAhead {
        /// Most rows of look-ahead.
        most: usize,
        /// Rows asked for.
        found: usize,
    },
    /// A hold of nothing.
    #[error("hold of 0 rows, at least 1 expected: use 1 for a label per window")]
    Hold,
    /// No classes, or too many.
    #[error("{found} classes, 1 to {most} expected: check the model")]
    Classes {
        /// Most classes.
        most: usize,
        /// Classes asked for.
        found: usize,
    },
    /// Rows that stand for no sample.
    #[error("rows of 0 samples, at least 1 expected")]
    RowSamples,
    /// A weight that is negative or no number.
    #[error("weight factor {found}, a finite one of 0 or more expected: use 1 for equal weights")]
    MaxFactor {
        /// The factor asked for.
        found: f32,
    },
}
