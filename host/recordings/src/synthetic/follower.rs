//! A simulated person who follows cues that come one after another.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use shared::units::Sample;

use super::SynthOptions;
use super::wearer::{Muscle, Wearer};
use crate::labels::motion::Motion;
use crate::recording::movement::MovementKind;
use crate::seed::generator;

/// Samples of each movement of a person who may do any.
const WHIM: u32 = 300;

/// A person who follows cues, a reaction time later.
pub struct Follower {
    wearer: Wearer,
    muscle: Muscle,
    random: ChaCha8Rng,
    motion: Motion,
    /// The last cue; `wait` is the number of samples until the muscle follows it.
    asked: Motion,
    wait: usize,
    /// Samples since the muscle began to follow the cue.
    since: u32,
}

impl std::fmt::Debug for Follower {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut debug = formatter.debug_struct("Follower");
        debug.field("asked", &self.asked).finish_non_exhaustive()
    }
}

impl Follower {
    /// The person of a name, with hand and arm at rest.
    pub fn new(name: &str) -> Self {
        let options = SynthOptions::default();
        let mut random = generator(options.seed, name);
        let wearer = Wearer::new(&mut random, options.label_lag_ms);
        Self {
            muscle: Muscle::at_rest(&wearer),
            wearer,
            random,
            motion: Motion::RELAX,
            asked: Motion::RELAX,
            wait: 0,
            since: 0,
        }
    }

    /// Makes the same person at another time. Each number has random values of its own.
    pub fn another_time(mut self, number: u64) -> Self {
        self.random = generator(number, "another time");
        self
    }

    /// Next sample, while `asked` is cued; a cue of [`Motion::OTHER`] is followed by any movement, another every 1.5 s.
    pub fn sample(&mut self, asked: impl Into<Motion>) -> Sample {
        let asked = asked.into();
        if asked != self.asked {
            self.asked = asked;
            self.since = 0;
            self.wait = self.wearer.reaction(&mut self.random);
        }
        if self.wait > 0 {
            self.wait -= 1;
        } else {
            self.choose();
            self.since = self.since.wrapping_add(1);
        }
        self.muscle
            .sample(&self.wearer, self.motion, &mut self.random)
    }

    /// Chooses the motion for the cue.
    fn choose(&mut self) {
        if self.asked != Motion::OTHER {
            self.motion = self.asked;
        } else if self.since.is_multiple_of(WHIM) {
            let kinds = MovementKind::NO_INTENT;
            self.motion = Motion::Other(kinds[self.random.random_range(0..kinds.len())]);
        }
    }
}
