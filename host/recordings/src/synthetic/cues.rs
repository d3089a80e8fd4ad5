//! The labels of a synthetic recording: what the person is cued to do.

use rand::{Rng, RngExt};
use shared::intent::{Intent, Vocabulary};

/// The label of every sample: rests and gestures of random length, sometimes gesture to gesture.
pub(super) fn cues(vocabulary: Vocabulary, samples: usize, random: &mut impl Rng) -> Vec<Intent> {
    let gestures = &vocabulary.intents()[1..];
    let mut cues = Vec::with_capacity(samples);
    let mut intent = Intent::Relax;
    while cues.len() < samples {
        let length = if intent == Intent::Relax {
            200..600
        } else {
            240..800
        };
        let length = random.random_range(length).min(samples - cues.len());
        cues.extend(std::iter::repeat_n(intent, length));
        let direct = intent == Intent::Relax || random.random_bool(0.2);
        intent = if direct {
            other_than(intent, gestures, random)
        } else {
            Intent::Relax
        };
    }
    cues
}

fn other_than(intent: Intent, gestures: &[Intent], random: &mut impl Rng) -> Intent {
    loop {
        let next = gestures[random.random_range(0..gestures.len())];
        if next != intent {
            return next;
        }
    }
}
