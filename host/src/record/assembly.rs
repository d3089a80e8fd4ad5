//! From a journal's entries to recordings: samples in order, what was asked for at each, and labels of the muscle.
//!
//! A recording is a stretch of one round without a gap. Up to five missing samples are bridged as a board bridges them, by
//! repeating the last one, and said so; more begin another recording.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use shared::intent::Intent;
use shared::stream::alignment::Alignment;
use shared::units::{Sample, SampleIndex};

use super::journal::Entry;
use super::session::{Bad, Continuity, Continuous};
use recordings::labels::cued::{Hold, follow};
use recordings::labels::motion::motions;

/// Samples of rest on either side of where a long part is cut.
const REST_AROUND: usize = 100;

/// A recording, one entry a sample in each list.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Part {
    /// Round, from 1 on.
    pub round: u32,
    /// As they came; those that are bridged repeat the one before.
    pub samples: Vec<Sample>,
    /// Number in the stream.
    pub index: Vec<u32>,
    /// Whether the sample never came.
    pub bridged: Vec<bool>,
    /// How the armband sat, as the board was aligned.
    pub placements: Vec<Alignment>,
    /// What was asked for.
    pub cues: Vec<Option<Intent>>,
    /// Attempt; 0 outside.
    pub trials: Vec<u32>,
    /// Label of the muscle; none where it is unknown, or the trial is not to be used.
    pub labels: Vec<Option<Intent>>,
    /// Every hold of the trials that are used.
    pub holds: Vec<Hold>,
}

/// A session as it was recorded.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Take {
    /// In order; none is empty.
    pub parts: Vec<Part>,
    /// Trials that are not used.
    pub bad: BTreeMap<u32, Bad>,
    /// Samples that never came, where they are known to be missing.
    pub lost: u64,
    /// Whether the session came to its end.
    pub complete: bool,
}

impl Take {
    /// The classes that every model has, and those that were asked for.
    pub fn classes(&self) -> Vec<Intent> {
        let cues = self.parts.iter().flat_map(|part| &part.cues);
        let always = [Intent::Relax, Intent::Open, Intent::Close];
        let asked = always.iter().chain(cues.flatten());
        let asked: BTreeSet<usize> = asked.map(|intent| intent.class()).collect();
        asked.into_iter().filter_map(Intent::from_class).collect()
    }
}

/// Puts the recordings together.
pub(crate) fn assemble(entries: &[Entry]) -> Take {
    let mut take = Take::default();
    let mut stream = Continuous::default();
    let mut stretch = Stretch::default();
    let mut round = 0;
    for entry in entries {
        match entry {
            Entry::Begin(_) => {}
            Entry::Samples { first, emg } => {
                let samples = Entry::decoded(emg).unwrap_or_default();
                let count = samples.len() as u32;
                let first = SampleIndex(*first);
                match stream.take(first, count) {
                    Continuity::Next => {}
                    Continuity::Bridged(missing) => {
                        take.lost += u64::from(missing);
                        stretch.bridge(missing);
                    }
                    Continuity::Lost(missing) => {
                        take.lost += u64::from(missing);
                        take.parts.extend(stretch.end(&mut round));
                    }
                    Continuity::Restart => take.parts.extend(stretch.end(&mut round)),
                }
                stretch.push(first, &samples);
            }
            Entry::Placement { turn, mirrored } => {
                stretch.placement = Alignment::new(*turn, *mirrored);
            }
            Entry::Break => {
                take.parts.extend(stretch.end(&mut round));
                stream = Continuous::default();
            }
            Entry::Round { number, at } => stretch.rounds.push((*at, *number)),
            Entry::Cue { at, cue, trial } => {
                stretch
                    .cues
                    .push((*at, Entry::intent(cue.as_ref()), *trial));
            }
            Entry::Bad { trial, why } => {
                take.bad.insert(*trial, *why);
            }
            Entry::Over => take.complete = true,
        }
    }
    take.parts.extend(stretch.end(&mut round));
    for part in &mut take.parts {
        part.label(&take.bad);
    }
    take
}

/// Samples without a gap, and what was said about them: a cue may be written before the samples that it begins with.
#[derive(Default)]
struct Stretch {
    first: u32,
    samples: Vec<Sample>,
    bridged: Vec<bool>,
    placements: Vec<Alignment>,
    /// From the next sample on.
    placement: Alignment,
    cues: Vec<(u32, Option<Intent>, u32)>,
    rounds: Vec<(u32, u32)>,
    /// Of the cues before.
    carried: (Option<Intent>, u32),
}

impl Stretch {
    fn push(&mut self, first: SampleIndex, samples: &[Sample]) {
        if self.samples.is_empty() {
            self.first = first.0;
        }
        self.samples.extend_from_slice(samples);
        self.bridged.resize(self.samples.len(), false);
        self.placements.resize(self.samples.len(), self.placement);
    }

    fn bridge(&mut self, missing: u32) {
        if let Some(&last) = self.samples.last() {
            let count = self.samples.len() + missing as usize;
            self.samples.resize(count, last);
            self.bridged.resize(count, true);
            self.placements.resize(count, self.placement);
        }
    }

    /// The recordings of the stretch, one a round; what follows is another one.
    fn end(&mut self, round: &mut u32) -> Vec<Part> {
        let mut parts: Vec<Part> = Vec::new();
        let (mut cue, mut trial) = self.carried;
        let (mut cues, mut rounds) = (self.cues.iter().peekable(), self.rounds.iter().peekable());
        let mut begins = true;
        for (place, (&sample, &bridged)) in self.samples.iter().zip(&self.bridged).enumerate() {
            let index = self.first.wrapping_add(place as u32);
            while let Some((_, number)) = rounds.next_if(|(at, _)| has_come(*at, index)) {
                *round = *number;
                begins = true;
            }
            while let Some((_, next, number)) = cues.next_if(|(at, ..)| has_come(*at, index)) {
                (cue, trial) = (*next, *number);
            }
            if begins {
                parts.push(Part {
                    round: *round,
                    ..Part::default()
                });
                begins = false;
            }
            if let Some(part) = parts.last_mut() {
                part.samples.push(sample);
                part.index.push(index);
                part.bridged.push(bridged);
                part.placements.push(self.placements[place]);
                part.cues.push(cue);
                part.trials.push(trial);
            }
        }
        // What is said about samples that are still to come holds for those.
        let cues = cues.copied().collect();
        let rounds = rounds.copied().collect();
        *self = Self {
            cues,
            rounds,
            carried: (cue, trial),
            placement: self.placement,
            ..Self::default()
        };
        parts
    }
}

/// Whether an index is `at` or after it; right across a wrap.
const fn has_come(at: u32, index: u32) -> bool {
    index.wrapping_sub(at) <= u32::MAX / 2
}

impl Part {
    /// The part in files of at most so many samples. A file ends in the middle of a rest where there is one in its second half.
    pub(crate) fn files(&self, most: usize) -> Vec<Range<usize>> {
        let mut files = Vec::new();
        let mut start = 0;
        while self.samples.len() - start > most {
            let is_rest = |at: usize| {
                let around = &self.labels[at - REST_AROUND..at + REST_AROUND];
                around.iter().all(|label| *label == Some(Intent::Relax))
            };
            let latest = start + most - REST_AROUND;
            let earliest = start + (most / 2).max(REST_AROUND);
            let cut = (earliest..latest).rev().find(|&at| is_rest(at));
            let end = cut.unwrap_or(start + most);
            files.push(start..end);
            start = end;
        }
        files.push(start..self.samples.len());
        files
    }

    fn label(&mut self, bad: &BTreeMap<u32, Bad>) {
        let followed = follow(&self.samples, &motions(&self.cues));
        self.labels = followed
            .motions
            .iter()
            .map(|motion| motion.label())
            .collect();
        for (label, trial) in self.labels.iter_mut().zip(&self.trials) {
            if bad.contains_key(trial) {
                *label = None;
            }
        }
        let used = |hold: &Hold| !bad.contains_key(&self.trials[hold.samples.start]);
        self.holds = followed.holds.into_iter().filter(used).collect();
    }
}

#[cfg(test)]
mod tests;
