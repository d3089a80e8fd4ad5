//! Pieces of one transition each, joined so that labels fit.
//!
//! A piece reaches from somewhere in the middle of one run to somewhere in the middle of the next.
//! A piece that starts in label A follows one that ended in A. A run of none (`scissor`) is a label
//! like any other here, and its pieces are kept: without them rest would never follow a gesture
//! outside the vocabulary. Steady holds (minutes of rest) go in between as random crops.

use std::collections::BTreeSet;
use std::ops::Range;

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;

use super::SpliceOptions;
use super::holds::Holds;
use super::joined::{Joined, crop};
use crate::labels::runs::{Run, runs};
use crate::recording::Recording;

/// Chance that a steady hold of the current label comes before the next transition.
const STEADY: f64 = 0.3;
/// Samples of a crop of such a hold: 1 to 5 s.
const STEADY_FOR: Range<usize> = 200..1000;

/// One transition and the places where it may be cut.
pub(super) struct Piece<'r> {
    recording: &'r Recording,
    from: Option<Intent>,
    to: Option<Intent>,
    start: Range<usize>,
    end: Range<usize>,
}

/// The pieces of a subject's recordings.
pub(super) fn pieces<'r>(recordings: &[&'r Recording]) -> Vec<Piece<'r>> {
    let mut pieces: Vec<Piece<'r>> = recordings.iter().flat_map(|own| pieces_of(own)).collect();
    // A piece into a label that no piece starts in (a motion without a recorded end) would stop the walk.
    loop {
        let starts: BTreeSet<_> = pieces.iter().map(|p| p.from).collect();
        let before = pieces.len();
        pieces.retain(|p| starts.contains(&p.to));
        if pieces.len() == before {
            return pieces;
        }
    }
}

fn pieces_of(recording: &Recording) -> Vec<Piece<'_>> {
    // The middle half: of a rest of 1 s a quarter covers most people's deviation from the lag.
    // Joined runs are then 0.5 to 1.5 times as long as the recorded ones.
    let middle = |run: &Run| {
        let quarter = run.samples() / 4;
        run.start + quarter..run.end - quarter
    };
    runs(&recording.labels)
        .windows(2)
        .map(|pair| Piece {
            recording,
            from: pair[0].label,
            to: pair[1].label,
            start: middle(&pair[0]),
            end: middle(&pair[1]),
        })
        .collect()
}

/// Joins pieces. The next label is drawn first, then one of its pieces: a gesture that was recorded
/// often does not come more often.
pub(super) fn walk(
    pieces: &[Piece<'_>],
    holds: &Holds<'_>,
    options: &SpliceOptions,
    random: &mut ChaCha8Rng,
) -> Option<Joined> {
    let mut joined = Joined::default();
    let mut label = pieces.choose(random)?.from;
    while joined.samples.len() < options.samples {
        // A hold may be longer than any cued run, as rest in daily use is.
        if let Some(steady) = holds.get(&label)
            && random.random_bool(STEADY)
        {
            let recording = steady.choose(random)?;
            let crop = crop(recording, STEADY_FOR, random);
            joined.append(recording, crop, options);
            continue;
        }
        let here: Vec<_> = pieces.iter().filter(|p| p.from == label).collect();
        let nexts: BTreeSet<_> = here.iter().map(|p| p.to).collect();
        let next = *Vec::from_iter(nexts).choose(random)?;
        let fitting: Vec<_> = here.into_iter().filter(|p| p.to == next).collect();
        let piece = fitting.choose(random)?;
        let start = random.random_range(piece.start.clone());
        let end = random.random_range(piece.end.clone());
        joined.append(piece.recording, start..end, options);
        label = next;
    }
    Some(joined)
}
