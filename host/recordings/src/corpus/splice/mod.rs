//! Splicing breaks order and rhythm: the same holds and transitions, in random order and of random length.
//!
//! `roshambo` always cues rock, paper, scissor, two seconds each and one of rest: a window of 3 s
//! learns to predict the next gesture from the order. Spliced, only the muscle activity predicts it.
//!
//! A person's recordings, with lag-compensated labels, are cut into pieces of one transition each
//! (`transitions`) and joined at random so that labels fit. Where no transition was recorded
//! (`cote-allard`: steady holds), random crops of the holds are joined instead (`holds`).

mod holds;
mod joined;
#[cfg(test)]
mod tests;
mod transitions;

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
        let pieces = transitions::pieces(&recordings);
        let holds = holds::holds(&recordings, options.other);
        for index in 0..options.count {
            let seed = options.seed ^ (index as u64).rotate_left(32);
            let mut random = seed::generator(seed, subject);
            let joined = if pieces.is_empty() {
                holds::walk(&holds, options, &mut random)
            } else {
                transitions::walk(&pieces, &holds, options, &mut random)
            };
            let set = recordings[0].data_set;
            spliced.extend(joined.map(|joined| Recording {
                name: format!("spliced-{index}"),
                timing: recordings[0].timing,
                notes: vec![format!("spliced from {} recordings", recordings.len())],
                other_movement: joined.other,
                ..Recording::new(set, subject, joined.samples, joined.labels)
            }));
        }
    }
    spliced
}
