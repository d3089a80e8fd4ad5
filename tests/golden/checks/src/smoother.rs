//! Checks of look-ahead and hold against the reference's live aggregator.

use alloc::{string::String, vec::Vec};

use serde::{Deserialize, Serialize};
use shared::stream::smoother::{AggregationMode, Settings, Smoother};
use shared::units::SampleIndex;

/// Number of classes: three intents, and MASK, which the reference lets win.
pub const CLASSES: usize = 4;
/// Number of rows that the files keep of every window.
pub const TAIL: usize = 52;

/// Windows and the reference's labels under many settings.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Set {
    /// Name in the reference's files.
    pub name: String,
    /// Newest rows of every window, oldest first, [`TAIL`] x [`CLASSES`] a window, in 1/256.
    pub tails: Vec<i16>,
    /// Cases with their settings.
    pub cases: Vec<Case>,
}

/// Settings, and the labels under them.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Case {
    /// True for [`AggregationMode::SameInstant`], false for [`AggregationMode::AllRowsFrom`].
    pub same_instant: bool,
    /// Look-ahead in rows, here samples.
    pub look_ahead: u32,
    /// Hold in windows.
    pub hold: u32,
    /// Labels, one per window; `None` where no label was due.
    pub labels: Vec<Option<u8>>,
}

impl Case {
    fn settings(&self) -> Settings {
        Settings {
            aggregation: match self.same_instant {
                true => AggregationMode::SameInstant,
                false => AggregationMode::AllRowsFrom,
            },
            look_ahead: self.look_ahead as usize,
            hold: self.hold as usize,
            row_samples: 1,
            ..Settings::PAPER_IN_PATCHES
        }
    }
}

/// Asserts that the labels equal those of the reference's live aggregator in every case.
pub fn live(set: &Set) {
    let scores: Vec<f32> = set
        .tails
        .iter()
        .map(|score| f32::from(*score) / 256.0)
        .collect();
    let windows: Vec<[[f32; CLASSES]; TAIL]> = (scores.as_chunks::<CLASSES>().0)
        .as_chunks::<TAIL>()
        .0
        .iter()
        .map(|oldest_first| {
            let mut rows = *oldest_first;
            rows.reverse();
            rows
        })
        .collect();
    assert!(!set.cases.is_empty(), "{}: no cases", set.name);
    for case in &set.cases {
        let settings = case.settings();
        let mut smoother = Smoother::<CLASSES, TAIL>::new(settings, CLASSES).expect("settings");
        let emitted: Vec<_> = (599..)
            .zip(&windows)
            .map(|(end, rows)| {
                let decision = smoother.push(SampleIndex(end), rows)?;
                assert_eq!(decision.instant.0, end - case.look_ahead);
                u8::try_from(decision.class).ok()
            })
            .collect();
        assert_eq!(emitted, case.labels, "{}: {settings:?}", set.name);
    }
}
