//! Steady holds: recordings of a single label.
//!
//! Random crops of them are joined, with or without rest between two gestures. The result has the
//! changes between open and close that the public sets lack; they are abrupt, unlike those of a muscle.

use std::collections::BTreeMap;
use std::ops::Range;

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;

use super::SpliceOptions;
use super::joined::{Joined, crop};
use crate::labels::runs::runs;
use crate::recording::Recording;

/// Samples of a crop of a steady hold: 0.6 to 3 s.
pub(super) const HOLD: Range<usize> = 120..601;
/// Chance of rest between two steady gestures.
const REST_BETWEEN: f64 = 0.6;

/// Recordings of one steady label, by label; none is movement outside the vocabulary.
pub(super) type Holds<'r> = BTreeMap<Option<Intent>, Vec<&'r Recording>>;

/// The steady holds among a subject's recordings, of movement outside the vocabulary if it is a class.
pub(super) fn holds<'r>(recordings: &[&'r Recording], other_is_a_class: bool) -> Holds<'r> {
    let is_other_movement = |own: &Recording| {
        let covered: usize = own.other_movement.iter().map(|own| own.samples.len()).sum();
        other_is_a_class && covered > 0 && covered >= own.labels.len()
    };
    let mut holds: Holds<'r> = BTreeMap::new();
    for &own in recordings {
        if let [run] = runs(&own.labels)[..]
            && (run.label.is_some() || is_other_movement(own))
        {
            holds.entry(run.label).or_default().push(own);
        }
    }
    holds
}

/// Joins crops of holds; none if there are fewer than two labels.
pub(super) fn walk(
    holds: &Holds<'_>,
    options: &SpliceOptions,
    random: &mut ChaCha8Rng,
) -> Option<Joined> {
    const RELAX: Option<Intent> = Some(Intent::Relax);
    let gestures = holds.keys().copied().filter(|&label| label != RELAX);
    let gestures: Vec<Option<Intent>> = gestures.collect();
    let rests = holds.contains_key(&RELAX);
    if gestures.len() + usize::from(rests) < 2 {
        return None;
    }
    let mut joined = Joined::default();
    let mut label = *gestures.choose(random)?;
    while joined.samples.len() < options.samples {
        let recording = holds[&label].choose(random)?;
        let crop = crop(recording, HOLD, random);
        joined.append(recording, crop, options);

        let others: Vec<_> = gestures.iter().copied().filter(|&g| g != label).collect();
        let rest = rests && label != RELAX;
        label = if rest && (others.is_empty() || random.random_bool(REST_BETWEEN)) {
            RELAX
        } else {
            *others.choose(random)?
        };
    }
    Some(joined)
}
