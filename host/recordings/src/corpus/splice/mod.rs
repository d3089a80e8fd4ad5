//! Splicing breaks order and rhythm: the same holds and transitions, in random order and of random length.
//!
//! `roshambo` always cues rock, paper, scissor, two seconds each and one of rest: a window of 3 s
//! learns to predict the next gesture from the order. Spliced, only the muscle activity predicts it.
//!
//! A person's recordings, with lag-compensated labels, are cut into pieces of one transition each
//! (`transitions`) and joined at random so that labels fit. Where no transition was recorded
//! (`cote-allard`: steady holds), random crops of the holds are joined instead (`holds`).

mod holds;
mod source;
#[cfg(test)]
mod tests;
mod transitions;

use rand_chacha::ChaCha8Rng;

use self::holds::Holds;
use self::source::{Joined, SpliceSource};
use self::transitions::Piece;
use crate::recording::{Recording, by};
use crate::seed;

/// Length, number and seed of spliced recordings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SpliceOptions {
    /// Samples of every spliced recording.
    pub samples: usize,
    /// Number of spliced recordings of every subject.
    pub count: usize,
    /// Whether movement outside the vocabulary is a class: it is marked, and steady holds of it are used.
    pub other: bool,
    /// Seed of every draw; a subject's draws do not depend on the other subjects.
    pub seed: u64,
}

/// Splices every subject's labelled recordings. Pass recordings of one data set with lag-compensated labels, whose
/// [`Recording::other_movement`] is all movement outside the vocabulary.
///
/// Returns `count` recordings, `spliced-0` and on, for each subject with at least one usable
/// transition or two different steady holds, in alphabetical order of subjects. Their path is
/// empty: they come from no file.
pub fn splice(recordings: &[&Recording], options: &SpliceOptions) -> Vec<Recording> {
    let is_used = |recording: &&Recording| {
        recording.has_labels() || options.other && !recording.other_movement.is_empty()
    };
    let used = recordings.iter().copied().filter(is_used);
    let mut spliced = Vec::new();
    for (subject, recordings) in by(used, |own| own.subject.as_str()) {
        let sources = recordings.iter();
        let sources = sources.map(|own| SpliceSource::new(own, options.other));
        let sources: Vec<SpliceSource<'_>> = sources.collect();
        let material = Material::of(&sources);
        for index in 0..options.count {
            let seed = options.seed ^ (index as u64).rotate_left(32);
            let mut random = seed::generator(seed, subject);
            let Some(Joined {
                samples,
                labels,
                other,
            }) = material.walk(options.samples, &mut random)
            else {
                continue;
            };
            spliced.push(Recording {
                name: format!("spliced-{index}"),
                timing: recordings[0].timing,
                notes: vec![format!("spliced from {} recordings", recordings.len())],
                other_movement: other,
                ..Recording::new(recordings[0].data_set, subject, samples, labels)
            });
        }
    }
    spliced
}

/// The parts of a subject's recordings that are joined.
enum Material<'a> {
    Transitions(Vec<Piece<'a>>, Holds<'a>),
    Holds(Holds<'a>),
}

impl<'a> Material<'a> {
    fn of(sources: &'a [SpliceSource<'a>]) -> Self {
        let pieces = transitions::pieces(sources);
        let holds = holds::holds(sources);
        if pieces.is_empty() {
            Self::Holds(holds)
        } else {
            Self::Transitions(pieces, holds)
        }
    }

    fn walk(&self, samples: usize, random: &mut ChaCha8Rng) -> Option<Joined> {
        match self {
            Self::Transitions(pieces, holds) => transitions::walk(pieces, holds, samples, random),
            Self::Holds(holds) => holds::walk(holds, samples, random),
        }
    }
}
