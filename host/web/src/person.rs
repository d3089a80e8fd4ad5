//! Simulated person of the demo: follows cues, and opens the hand twice for an alignment.

use recordings::labels::motion::Motion;
use recordings::synthetic::Follower;
use shared::intent::Intent;
use shared::units::{Sample, SampleIndex};

/// Samples for which the person rests before each opening, and for which it then holds the hand open.
const REST: usize = 240;
const OPEN: usize = 300;

/// Samples of rest at the beginning of an alignment, after which no earlier gesture can be taken for an opening.
const SETTLED: usize = 200;

/// Source of the cues that a person follows.
#[derive(Debug)]
pub enum Cues {
    /// Cue of each sample, repeated.
    List(Vec<Intent>),
    /// Motion that a recording session asks for.
    Session(Motion),
}

/// Simulated person, and what it was asked for.
#[derive(Debug)]
pub struct DemoPerson {
    follower: Follower,
    cues: Cues,
    /// Samples since the alignment in progress began.
    aligning: Option<usize>,
    /// Gesture that a calibration or a task in progress asks for.
    calibrating: Option<Intent>,
    /// Places that the armband is turned by.
    turn: usize,
}

impl DemoPerson {
    /// Person before the first sample.
    pub fn new(follower: Follower, cues: Cues) -> Self {
        Self {
            follower,
            cues,
            aligning: None,
            calibrating: None,
            turn: 0,
        }
    }

    /// Tells what a recording session asks for.
    pub fn ask(&mut self, cue: Motion) {
        self.cues = Cues::Session(cue);
    }

    /// Turns the armband by three places, or back.
    pub const fn turn(&mut self) {
        self.turn = 3 - self.turn;
    }

    /// Tells whether an alignment is in progress. Returns whether the person has come to rest for it with the last sample.
    pub fn align(&mut self, is_aligning: bool) -> bool {
        self.aligning = is_aligning.then(|| self.aligning.unwrap_or(0));
        self.aligning == Some(SETTLED)
    }

    /// Tells what a calibration or a task in progress asks for.
    pub const fn calibrate(&mut self, cue: Option<Intent>) {
        self.calibrating = cue;
    }

    /// Returns the next samples, from `first` on, and their cues; none where a session has its own.
    pub fn next<const COUNT: usize>(
        &mut self,
        first: SampleIndex,
    ) -> ([Sample; COUNT], [Option<Intent>; COUNT]) {
        let session = match self.cues {
            Cues::Session(cue) => Some(cue),
            Cues::List(_) => None,
        };
        let mut cues = [None; COUNT];
        let samples = std::array::from_fn(|place| {
            let own = match (&mut self.aligning, self.calibrating, &self.cues) {
                (Some(samples), ..) => Some(opening(samples)),
                (None, Some(cue), _) => Some(cue),
                (None, None, Cues::List(list)) => {
                    Some(list[(first.0 as usize + place) % list.len()])
                }
                (None, None, Cues::Session(_)) => None,
            };
            cues[place] = own;
            let mut sample = match (own, session) {
                (None, Some(cue)) => self.follower.sample(cue),
                (own, _) => self.follower.sample(own.unwrap_or(Intent::Relax)),
            };
            sample.rotate_right(self.turn);
            sample
        });
        (samples, cues)
    }
}

/// Cue of the next sample of an alignment: rest and an open hand by turns.
fn opening(samples: &mut usize) -> Intent {
    let place = *samples % (REST + OPEN);
    *samples += 1;
    if place < REST {
        Intent::Relax
    } else {
        Intent::Open
    }
}
