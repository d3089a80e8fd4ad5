//! Numbers of gestures: asked for, and scored.
//!
//! Labels at each cue's own lag leave out a gesture if the muscle does not show when its cue was followed, weak ones
//! among them. Such a gesture is not scored, so their number is part of a result.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use shared::intent::Intent;

use super::evaluated_recording::EvaluatedRecording;
use super::metric::event::gesture::gestures;
use recordings::DataSet;

/// Numbers of gestures, counted as [`gesture`](super::metric::event::gesture) counts them.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Cued {
    /// Gestures in the published labels.
    pub cued: usize,
    /// Gestures in the lag-compensated labels.
    pub scored: usize,
}

impl Cued {
    /// Gestures that are not scored.
    pub const fn left_out(self) -> usize {
        self.cued.saturating_sub(self.scored)
    }
}

/// Numbers of gestures, by data set.
pub fn cued<'t>(
    recordings: impl IntoIterator<Item = &'t EvaluatedRecording>,
) -> BTreeMap<DataSet, Cued> {
    let mut by_set: BTreeMap<DataSet, Cued> = BTreeMap::new();
    for recording in recordings {
        let Some(published) = &recording.published else {
            continue;
        };
        let own = by_set.entry(recording.data_set).or_default();
        own.cued += count(published);
        own.scored += count(&recording.lag_compensated);
    }
    by_set
}

fn count(truth: &[Option<Intent>]) -> usize {
    let nothing = vec![None; truth.len()];
    gestures(truth, &nothing).len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gesture_without_a_label_is_left_out() {
        let mut recording = EvaluatedRecording::made_up("a", &[0, 2, 0, 2, 0]);
        let both = cued([&recording])[&recording.data_set];
        assert_eq!((both, both.left_out()), (Cued { cued: 2, scored: 2 }, 0));
        recording.lag_compensated[400..900].fill(None);
        let one = cued([&recording])[&recording.data_set];
        assert_eq!((one, one.left_out()), (Cued { cued: 2, scored: 1 }, 1));
        // Spliced recordings have no cues that a person was asked for.
        recording.published = None;
        assert!(cued([&recording]).is_empty());
    }
}
