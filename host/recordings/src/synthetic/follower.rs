//! A simulated person who follows cues that come one after another.

use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::Sample;

use super::SynthOptions;
use super::wearer::{Muscle, Wearer};
use crate::seed::generator;

/// A person who follows cues, a reaction time later.
pub struct Follower {
    wearer: Wearer,
    muscle: Muscle,
    random: ChaCha8Rng,
    intent: Intent,
    /// The last cue; `wait` is the number of samples until the muscle follows it.
    asked: Intent,
    wait: usize,
}

impl std::fmt::Debug for Follower {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut debug = formatter.debug_struct("Follower");
        debug.field("asked", &self.asked).finish_non_exhaustive()
    }
}

impl Follower {
    /// The person of a name, with hand and arm at rest.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let options = SynthOptions::default();
        let mut random = generator(options.seed, name);
        let wearer = Wearer::new(&mut random, options.label_lag_ms);
        Self {
            muscle: Muscle::at_rest(&wearer),
            wearer,
            random,
            intent: Intent::Relax,
            asked: Intent::Relax,
            wait: 0,
        }
    }

    /// Next sample, while `asked` is cued.
    pub fn sample(&mut self, asked: Intent) -> Sample {
        if asked != self.asked {
            self.asked = asked;
            self.wait = self.wearer.reaction(&mut self.random);
        }
        if self.wait == 0 {
            self.intent = self.asked;
        } else {
            self.wait -= 1;
        }
        self.muscle
            .sample(&self.wearer, self.intent, &mut self.random)
    }

    /// Intent that the muscle follows now.
    #[must_use]
    pub const fn intent(&self) -> Intent {
        self.intent
    }
}
