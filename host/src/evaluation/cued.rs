//! Gestures that were asked for, and those of them that a truth keeps.
//!
//! Labels at each cue's own lag leave a gesture out that no muscle follows, weak ones among them. What a model would do with
//! these gestures is then not scored, so their number is part of a result.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use shared::intent::Intent;

use super::trial::Trial;
use crate::dataset::{DataSet, runs};

/// Samples after a cue's end until which the muscle may begin to follow it: 1.5 s.
const LATE: usize = 300;

/// A number of gestures.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Cued {
    /// Gestures of the vocabulary that the published labels ask for.
    pub cued: usize,
    /// Of these, the ones that have a label in the lag-compensated truth.
    pub labelled: usize,
}

/// The gestures of each data set.
#[must_use]
pub fn cued(trials: &[Trial]) -> BTreeMap<DataSet, Cued> {
    let mut by_set: BTreeMap<DataSet, Cued> = BTreeMap::new();
    for trial in trials {
        let Some(published) = &trial.published else {
            continue;
        };
        let own = by_set.entry(trial.data_set).or_default();
        let found = in_recording(published, &trial.lag_compensated);
        own.cued += found.cued;
        own.labelled += found.labelled;
    }
    by_set
}

fn in_recording(published: &[Option<Intent>], truth: &[Option<Intent>]) -> Cued {
    let runs = runs(published);
    let mut found = Cued::default();
    for (at, run) in runs.iter().enumerate() {
        if run.label.is_none_or(|intent| intent == Intent::Relax) {
            continue;
        }
        let next = runs[at + 1..].iter().find(|next| next.label == run.label);
        let next = next.map_or(truth.len(), |next| next.start);
        found.cued += 1;
        found.labelled +=
            usize::from(truth[run.start..(run.end + LATE).min(next)].contains(&run.label));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gesture_without_a_label_of_its_own_is_left_out() {
        let (r, c) = (Some(Intent::Relax), Some(Intent::Close));
        let published = [
            vec![r; 400],
            vec![c; 400],
            vec![r; 400],
            vec![c; 400],
            vec![r; 400],
        ]
        .concat();
        let late = |by: usize| [vec![r; by], published[..published.len() - by].to_vec()].concat();
        let all = Cued {
            cued: 2,
            labelled: 2,
        };
        assert_eq!(in_recording(&published, &late(60)), all);
        let mut truth = late(60);
        truth[400..900].fill(None);
        assert_eq!(
            in_recording(&published, &truth),
            Cued {
                cued: 2,
                labelled: 1
            }
        );
        assert_eq!(in_recording(&[r; 9], &[r; 9]), Cued::default());
    }
}
