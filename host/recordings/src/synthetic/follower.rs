//! A simulated person who is asked for one thing after another, as it comes.

use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::Sample;

use super::SynthOptions;
use super::wearer::{Muscle, Wearer};
use crate::seed::generator;

/// A person who does what is asked for, a reaction time later.
pub struct Follower {
    wearer: Wearer,
    muscle: Muscle,
    random: ChaCha8Rng,
    intent: Intent,
    /// What was asked for last, and samples until the muscle begins with it.
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

    /// The next sample, while this is asked for.
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

    /// What the muscle does now.
    #[must_use]
    pub const fn intent(&self) -> Intent {
        self.intent
    }
}
