//! Assembly of recordings from a journal's entries: samples in order, the cue at each, and labels of the muscle.
//!
//! A recording is a stretch of one round without a gap. Up to five missing samples are bridged as on a board, by repeating
//! the last one, and marked so; a longer gap begins another recording.

use std::collections::BTreeMap;
use std::ops::Range;

use shared::intent::Intent;
use shared::myo::Imu;
use shared::stream::alignment::Alignment;
use shared::units::{Sample, SampleIndex};

use super::journal::{Entry, TOGETHER};
use super::session::{Continuity, IndexGapDetector, RejectReason, has_reached};
use recordings::labels::cued::{Hold, follow};
use recordings::labels::motion::Motion;

/// Samples of rest on either side of a cut in a long recording.
const REST_AROUND: usize = 100;

/// Recording; each list but `movement` and `holds` has one entry a sample.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct AssembledRecording {
    /// Samples as received; a bridged one repeats the one before.
    pub samples: Vec<Sample>,
    /// Index in the stream.
    pub index: Vec<u32>,
    /// Whether the sample never came.
    pub bridged: Vec<bool>,
    /// Placement of the armband, as the board was aligned.
    pub placements: Vec<Alignment>,
    /// Cue; unknown where nothing is asked for.
    pub cues: Vec<Motion>,
    /// Number of the attempt; 0 outside of trials.
    pub trials: Vec<u32>,
    /// Motion that the muscle shows; unknown if the trial is not used.
    pub motions: Vec<Motion>,
    /// Movement of the armband, at the offset of the sample that was due.
    pub movement: Vec<(usize, Imu)>,
    /// Holds of the trials that are used.
    pub holds: Vec<Hold>,
}

/// Recordings of a session.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Assembly {
    /// Recordings in order; none is empty.
    pub parts: Vec<AssembledRecording>,
    /// Trials that are not used, by their number, with the reason.
    pub rejected: BTreeMap<u32, RejectReason>,
    /// Number of samples known to be missing.
    pub lost: u64,
    /// Number of lines of the journal that are lost, and of samples in them.
    pub damaged: (u32, u64),
    /// Whether the session came to its end.
    pub complete: bool,
}

impl Assembly {
    /// Classes that every model has, and the motions of the cues.
    pub fn asked(&self) -> Vec<Motion> {
        let always = [Intent::Relax, Intent::Open, Intent::Close].map(Motion::Intent);
        let cues = self.parts.iter().flat_map(|part| &part.cues);
        let is_asked =
            |motion: &Motion| always.contains(motion) || cues.clone().any(|cue| cue == motion);
        Motion::named().filter(is_asked).collect()
    }
}

/// Assembles the recordings of a journal.
pub fn assemble(entries: &[Entry]) -> Assembly {
    let mut assembly = Assembly::default();
    let mut stream = IndexGapDetector::default();
    let mut stretch = Stretch::default();
    // Lines lost since the last samples.
    let mut damaged = 0_u32;
    for entry in entries {
        match entry {
            Entry::Begin(_) => {}
            Entry::Samples { first, emg } => {
                let samples = Entry::decoded(emg).unwrap_or_default();
                let count = samples.len() as u32;
                let first = SampleIndex(*first);
                match stream.take(first, count) {
                    Continuity::Bridged(missing) | Continuity::Lost(missing) if damaged > 0 => {
                        assembly.damaged.1 += u64::from(missing);
                    }
                    Continuity::Next => {}
                    Continuity::Bridged(missing) => {
                        assembly.lost += u64::from(missing);
                        stretch.bridge(missing);
                    }
                    Continuity::Lost(missing) => {
                        assembly.lost += u64::from(missing);
                        assembly.parts.extend(stretch.end());
                    }
                    Continuity::Restart => assembly.parts.extend(stretch.end()),
                }
                damaged = 0;
                stretch.push(first, &samples);
            }
            Entry::Imu { rows } => stretch.movement.extend(rows),
            Entry::Placement { turn, mirrored } => {
                stretch.placement = Alignment::new(*turn, *mirrored);
            }
            Entry::Break => {
                assembly.parts.extend(stretch.end());
                stream = IndexGapDetector::default();
            }
            Entry::Round { at, .. } => stretch.rounds.push(*at),
            Entry::Cue { at, cue, trial } => {
                stretch
                    .cues
                    .push((*at, Entry::motion(cue.as_ref()), *trial));
            }
            Entry::Rejected { trial, why } => {
                assembly.rejected.insert(*trial, *why);
            }
            Entry::Over => assembly.complete = true,
            Entry::Damage { lines } => {
                damaged = damaged.saturating_add(*lines);
                assembly.damaged.0 = assembly.damaged.0.saturating_add(*lines);
                assembly.parts.extend(stretch.end());
                for trial in stretch.trials_in_progress() {
                    let why = RejectReason::Lost;
                    assembly.rejected.entry(trial).or_insert(why);
                }
            }
        }
    }
    assembly.damaged.1 += u64::from(damaged) * TOGETHER as u64;
    assembly.parts.extend(stretch.end());
    for part in &mut assembly.parts {
        part.label(&assembly.rejected);
    }
    assembly
}

/// Samples without a gap, with their cues and rounds; a cue may be written before its first sample.
struct Stretch {
    first: u32,
    samples: Vec<Sample>,
    bridged: Vec<bool>,
    placements: Vec<Alignment>,
    /// Placement from the next sample on.
    placement: Alignment,
    cues: Vec<(u32, Motion, u32)>,
    movement: Vec<(u32, [i16; 10])>,
    /// First sample of each round.
    rounds: Vec<u32>,
    /// Cue and trial in force before the first of `cues`.
    carried: (Motion, u32),
}

impl Default for Stretch {
    fn default() -> Self {
        Self {
            first: 0,
            samples: Vec::new(),
            bridged: Vec::new(),
            placements: Vec::new(),
            placement: Alignment::NONE,
            cues: Vec::new(),
            movement: Vec::new(),
            rounds: Vec::new(),
            carried: (Motion::Unknown, 0),
        }
    }
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

    /// Trials that a lost line may have rejected or ended, of a stretch that has ended: those that have begun, and in the rest
    /// at the beginning of one the one before it.
    fn trials_in_progress(&self) -> impl Iterator<Item = u32> {
        let (cue, trial) = self.carried;
        let before = (cue == Motion::RELAX).then(|| trial.saturating_sub(1));
        let begun = self.cues.iter().map(|(_, _, trial)| *trial);
        let trials = before.into_iter().chain([trial]).chain(begun);
        trials.filter(|&trial| trial > 0)
    }

    /// Ends the stretch: returns its recordings, one a round.
    fn end(&mut self) -> Vec<AssembledRecording> {
        let mut parts: Vec<AssembledRecording> = Vec::new();
        let (mut cue, mut trial) = self.carried;
        let (mut cues, mut rounds) = (self.cues.iter().peekable(), self.rounds.iter().peekable());
        let mut begins = true;
        for (offset, (&sample, &bridged)) in self.samples.iter().zip(&self.bridged).enumerate() {
            let index = SampleIndex(self.first).plus(offset as u32);
            while rounds
                .next_if(|at| has_reached(index, SampleIndex(**at)))
                .is_some()
            {
                begins = true;
            }
            while let Some((_, next, number)) =
                cues.next_if(|(at, ..)| has_reached(index, SampleIndex(*at)))
            {
                (cue, trial) = (*next, *number);
            }
            if begins {
                parts.push(AssembledRecording::default());
                begins = false;
            }
            if let Some(part) = parts.last_mut() {
                part.samples.push(sample);
                part.index.push(index.0);
                part.bridged.push(bridged);
                part.placements.push(self.placements[offset]);
                part.cues.push(cue);
                part.trials.push(trial);
            }
        }
        for (due, imu) in self.movement.drain(..) {
            let place = parts.iter_mut().find_map(|part| {
                let offset = SampleIndex(due).since(SampleIndex(part.index[0])) as usize;
                (offset < part.index.len()).then_some((part, offset))
            });
            if let Some((part, offset)) = place {
                part.movement.push((offset, Imu(imu)));
            }
        }
        // Cues and rounds of later samples stay.
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

impl AssembledRecording {
    /// Splits the recording into files of at most `most` samples. A file ends within a rest, if its second half has one.
    pub fn files(&self, most: usize) -> Vec<Range<usize>> {
        let mut files = Vec::new();
        let mut start = 0;
        while self.samples.len() - start > most {
            let is_rest = |at: usize| {
                let around = &self.motions[at - REST_AROUND..at + REST_AROUND];
                around.iter().all(|motion| *motion == Motion::RELAX)
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

    fn label(&mut self, rejected: &BTreeMap<u32, RejectReason>) {
        let followed = follow(&self.samples, &self.cues);
        self.motions = followed.motions;
        for (motion, trial) in self.motions.iter_mut().zip(&self.trials) {
            if rejected.contains_key(trial) {
                *motion = Motion::Unknown;
            }
        }
        let used = |hold: &Hold| !rejected.contains_key(&self.trials[hold.samples.start]);
        self.holds = followed.holds.into_iter().filter(used).collect();
    }
}

#[cfg(test)]
mod tests;
