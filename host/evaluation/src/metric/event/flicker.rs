//! Flicker = label changes beyond the true ones / minutes of labelled time.
//!
//! The labelled time is cut `tolerance` before every change of the truth. Each part may contain one change of
//! the emitted label, for the true change that it begins with; every further one is counted. A change that comes in
//! another part than its true one is therefore counted, and a missed change does not make up for one too many
//! elsewhere. The first part of a recording may contain none; the first one after unlabelled samples may contain
//! one. The first label of a recording is not a change.

use shared::intent::Intent;

use super::TOLERANCE;
use super::activation::Rate;
use crate::metric::stretches;

/// Changes of the emitted label beyond the true ones, over the labelled time.
pub(super) fn flicker(truth: &[Option<Intent>], emitted: &[Option<Intent>]) -> Rate {
    let first = emitted.iter().position(Option::is_some);
    let changes: Vec<usize> = (1..emitted.len())
        .filter(|&at| emitted[at] != emitted[at - 1] && Some(at) != first)
        .collect();
    let within = |from: usize, to: usize| {
        changes.partition_point(|&at| at < to) - changes.partition_point(|&at| at < from)
    };
    let (mut count, mut samples) = (0, 0);
    for stretch in stretches(truth) {
        samples += stretch.len();
        let mut from = stretch.start;
        let mut allowed = usize::from(stretch.start > 0);
        for at in stretch.start + 1..stretch.end {
            if truth[at] != truth[at - 1] {
                let cut = at.saturating_sub(TOLERANCE).max(stretch.start);
                count += within(from, cut).saturating_sub(allowed);
                (from, allowed) = (cut, 1);
            }
        }
        count += within(from, stretch.end).saturating_sub(allowed);
    }
    Rate::of(count, samples)
}
