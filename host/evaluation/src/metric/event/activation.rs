//! False activations a minute = runs of an active label that begin in rest / minutes of rest.
//!
//! Rest: samples whose truth is relax and that no gesture owns ([`gesture`](super::gesture)). A label that began
//! before and is still there is not counted again. The same count over movements outside the vocabulary, which a
//! data set has to mark, says how often other use of the hand is taken for a gesture; over daily life, how often
//! something is said when nothing is meant.

use std::ops::Range;

use shared::intent::Intent;
use shared::units::SAMPLE_RATE_HZ;

use super::active;
use super::gesture::owners;

/// A number of events in a time.
#[derive(Clone, Copy, PartialEq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Rate {
    /// Events.
    pub count: usize,
    /// Time in which they could occur, in seconds.
    pub seconds: f64,
}

impl Rate {
    pub(super) fn of(count: usize, samples: usize) -> Self {
        Self {
            count,
            seconds: samples as f64 / f64::from(SAMPLE_RATE_HZ),
        }
    }

    /// Sum of both, counts and times.
    pub fn plus(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            seconds: self.seconds + other.seconds,
        }
    }

    /// Events a minute; none without any time.
    pub fn per_minute(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.count as f64 * 60.0 / self.seconds)
    }
}

/// Flags of the samples that are rest: the truth is relax, and no gesture owns the sample.
pub(crate) fn rest(truth: &[Option<Intent>]) -> Vec<bool> {
    let mut rest: Vec<bool> = truth
        .iter()
        .map(|&label| label == Some(Intent::Relax))
        .collect();
    for owner in owners(truth) {
        rest[owner.samples].fill(false);
    }
    rest
}

/// Runs of an active label that begin at a marked sample, over the marked time.
pub(crate) fn activations(emitted: &[Option<Intent>], mask: &[bool]) -> Rate {
    begun(emitted, (0..emitted.len()).filter(|&at| mask[at]))
}

/// Runs of an active label that begin at one of these samples, over their time.
fn begun(emitted: &[Option<Intent>], samples: impl Iterator<Item = usize> + Clone) -> Rate {
    let count = samples.clone().filter(|&at| begins(emitted, at)).count();
    Rate::of(count, samples.count())
}

/// Labels raised in a part of daily life, in which none is meant.
#[derive(Clone, Copy, PartialEq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct DailyUse {
    /// Activations.
    pub activations: Rate,
    /// Seconds with an active label.
    pub active_seconds: f64,
}

impl DailyUse {
    /// Activations within these samples, and how long their labels stay.
    pub(super) fn of(emitted: &[Option<Intent>], samples: Range<usize>) -> Self {
        let shown = samples.clone().filter(|&at| active(emitted[at]).is_some());
        Self {
            active_seconds: Rate::of(0, shown.count()).seconds,
            activations: begun(emitted, samples),
        }
    }

    /// Sum of both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            activations: self.activations.plus(other.activations),
            active_seconds: self.active_seconds + other.active_seconds,
        }
    }

    /// Share of the time with an active label; not a number without any time.
    pub fn active_share(self) -> f64 {
        self.active_seconds / self.activations.seconds
    }
}

/// Whether an active label begins within these samples; an earlier beginning does not count.
pub(crate) fn raises(emitted: &[Option<Intent>], mut samples: Range<usize>) -> bool {
    samples.any(|at| begins(emitted, at))
}

fn begins(emitted: &[Option<Intent>], at: usize) -> bool {
    active(emitted[at]).is_some() && (at == 0 || emitted[at - 1] != emitted[at])
}
