//! Parts of a person's recordings that are shown to a calibration.

use std::collections::BTreeMap;
use std::ops::Range;

use recordings::runs;
use shared::calibration::{MOST_PATCHES, Shown};
use shared::intent::{Intent, Vocabulary};
use shared::units::{PATCH, SAMPLE_RATE_HZ};

use crate::EvaluatedRecording;

/// Shortest hold, in samples: half a second.
const SHORTEST: usize = SAMPLE_RATE_HZ as usize / 2;
/// Most samples of a rest: what a calibration learns from. The remainder is judged.
const MOST_REST: usize = MOST_PATCHES * PATCH;
/// Most samples of one other movement: 1 s.
const MOST_OTHER: usize = SAMPLE_RATE_HZ as usize;
/// Other movements that are shown: six, 6 s.
const OTHERS: usize = 6;
/// Rests of a round.
const RESTS: usize = 2;

/// Part of a recording that is shown to a calibration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ShownPart {
    /// Index of the recording.
    pub recording: usize,
    /// Range of samples in the recording.
    pub samples: Range<usize>,
    /// Class that they show.
    pub shown: Shown,
    /// Round, from 0 on; other movement is shown in the first.
    pub round: usize,
}

/// Number of rounds in a person's recordings: holds of the gesture that is held least often, by lag-compensated labels; 0
/// without rest.
pub fn rounds_of(recordings: &[&EvaluatedRecording], vocabulary: Vocabulary) -> usize {
    let holds = holds(recordings);
    let gestures = vocabulary.intents()[1..].iter();
    let counts = gestures.map(|gesture| holds.get(gesture).map_or(0, Vec::len));
    let rest = holds.contains_key(&Intent::Relax);
    counts.min().filter(|_| rest).unwrap_or(0)
}

/// The first `rounds` rounds of a person's recordings, and up to six other movements, a second each, kinds in turn. At least
/// half of the other movements are left to be judged.
pub fn parts(
    recordings: &[&EvaluatedRecording],
    vocabulary: Vocabulary,
    rounds: usize,
) -> Vec<ShownPart> {
    let mut parts = Vec::new();
    for (intent, holds) in holds(recordings) {
        if !vocabulary.contains(intent) {
            continue;
        }
        let (a_round, most) = if intent == Intent::Relax {
            (RESTS, MOST_REST)
        } else {
            (1, usize::MAX)
        };
        let holds = holds.into_iter().take(rounds * a_round).enumerate();
        parts.extend(holds.map(|(place, (recording, samples))| ShownPart {
            recording,
            samples: samples.start..samples.end.min(samples.start.saturating_add(most)),
            shown: Shown::Intent(intent),
            round: place / a_round,
        }));
    }
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    let mut others = Vec::new();
    for (recording, own) in recordings.iter().enumerate() {
        for movement in &own.other_movement {
            if !movement.kind.is_daily() && movement.samples.len() >= SHORTEST {
                let turn = kinds.entry(movement.kind.name()).or_default();
                *turn += 1;
                others.push((*turn, recording, movement.samples.clone()));
            }
        }
    }
    others.sort_by_key(|(turn, recording, samples)| (*turn, *recording, samples.start));
    let count = OTHERS.min(others.len() / 2);
    let others = others.into_iter().take(count);
    parts.extend(others.map(|(_, recording, samples)| ShownPart {
        recording,
        samples: samples.start..samples.end.min(samples.start + MOST_OTHER),
        shown: Shown::Other,
        round: 0,
    }));
    parts
}

/// Holds of each intent in the order of the recordings.
fn holds(recordings: &[&EvaluatedRecording]) -> BTreeMap<Intent, Vec<(usize, Range<usize>)>> {
    let mut holds: BTreeMap<Intent, Vec<(usize, Range<usize>)>> = BTreeMap::new();
    for (recording, own) in recordings.iter().enumerate() {
        let long = runs(&own.lag_compensated).into_iter();
        for run in long.filter(|run| run.samples() >= SHORTEST) {
            if let Some(intent) = run.label {
                let own = holds.entry(intent).or_default();
                own.push((recording, run.start..run.end));
            }
        }
    }
    holds
}
