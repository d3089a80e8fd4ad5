//! Synthetic recordings, so that everything runs without a data set.
//!
//! A simplified model of forearm EMG: every intent activates the electrodes in a pattern of its own,
//! with crosstalk, and with gain and rotation by how a person wears the band; the activation rises
//! and falls in ramps, with tremor and fatigue; the signal is noise of that amplitude, its
//! neighbouring samples correlated as in real recordings. Labels are cues that the muscle follows
//! late. Results on it show that the code works, nothing about people.

mod follower;
pub mod losses;
mod wearer;
#[cfg(not(target_family = "wasm"))]
mod written;

use rand::{Rng, RngExt as _};
use shared::intent::{Intent, Vocabulary};
use shared::units::{SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ};

pub use self::follower::Follower;
use self::wearer::Wearer;
#[cfg(not(target_family = "wasm"))]
pub use self::written::write;
use super::catalogue::DataSet;
use super::labels::timing;
use super::recording::Recording;
use super::seed::generator;

/// Number, length and content of synthetic recordings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SynthOptions {
    /// Number of people, `s1` and on.
    pub subjects: usize,
    /// Number of recordings of each.
    pub recordings: usize,
    /// Seconds of each recording.
    pub seconds: usize,
    /// Intents that occur.
    pub vocabulary: Vocabulary,
    /// Mean time from a cue to half of the muscle's ramp, in ms, 100..=500.
    pub label_lag_ms: u32,
    /// Seed of every draw; a recording does not depend on the number of others.
    pub seed: u64,
}

impl Default for SynthOptions {
    /// 8 people, 4 recordings of a minute each, three classes, the set's [nominal lag](DataSet::label_lag).
    fn default() -> Self {
        Self {
            subjects: 8,
            recordings: 4,
            seconds: 60,
            vocabulary: Vocabulary::Three,
            label_lag_ms: DataSet::SYNTHETIC.label_lag() as u32 * SAMPLE_PERIOD_MS,
            seed: 42,
        }
    }
}

/// Generates the recordings in memory, ordered by person.
pub fn generate(options: &SynthOptions) -> Vec<Recording> {
    let people = 1..=options.subjects;
    let recordings = people.flat_map(|number| generate_person(options, number));
    recordings.collect()
}

/// Generates the recordings of one person in memory, as [`generate`] does; `number` is 1 for `s1`.
pub fn generate_person(options: &SynthOptions, number: usize) -> Vec<Recording> {
    let simulated = simulate_person(*options, number);
    let mut recordings: Vec<_> = simulated.map(|(recording, _)| recording).collect();
    timing::find(&mut recordings);
    recordings
}

/// The recordings, and the intent that the muscle follows at each of their samples.
fn simulate(options: &SynthOptions) -> impl Iterator<Item = (Recording, Vec<Intent>)> {
    let options = *options;
    (1..=options.subjects).flat_map(move |number| simulate_person(options, number))
}

/// Simulates one person, as [`simulate`] does.
fn simulate_person(
    options: SynthOptions,
    number: usize,
) -> impl Iterator<Item = (Recording, Vec<Intent>)> {
    let samples = options.seconds * SAMPLE_RATE_HZ as usize;
    let person = format!("s{number}");
    let wearer = Wearer::new(&mut generator(options.seed, &person), options.label_lag_ms);
    (1..=options.recordings).map(move |index| {
        let name = format!("{person}_synthetic_{index}");
        let mut random = generator(options.seed, &name);
        let cues = cues(options.vocabulary, samples, &mut random);
        let (samples, muscle) = wearer.perform(&cues, &mut random);
        let subject = format!("{}/{person}", DataSet::SYNTHETIC.name());
        let labels = cues.into_iter().map(Some).collect();
        let recording = Recording {
            name,
            ..Recording::new(DataSet::SYNTHETIC, subject, samples, labels)
        };
        (recording, muscle)
    })
}

/// Label of every sample, what the person is cued to do: rests and gestures of random length, sometimes gesture to gesture.
fn cues(vocabulary: Vocabulary, samples: usize, random: &mut impl Rng) -> Vec<Intent> {
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

#[cfg(test)]
mod tests {
    use super::wearer::BIAS;
    use super::*;
    use crate::labels::lag;

    pub(super) const SMALL: SynthOptions = SynthOptions {
        subjects: 3,
        recordings: 2,
        seconds: 30,
        vocabulary: Vocabulary::Six,
        label_lag_ms: 250,
        seed: 7,
    };

    #[test]
    fn a_recording_depends_on_its_seed_and_not_on_the_others() {
        let some = generate(&SMALL);
        assert_eq!(some, generate(&SMALL));
        let more = generate(&SynthOptions {
            subjects: 5,
            ..SMALL
        });
        assert_eq!(some[..], more[..some.len()]);
        assert_eq!(some[2..4], generate_person(&SMALL, 2));
        assert_ne!(some, generate(&SynthOptions { seed: 8, ..SMALL }));
        assert_ne!(some[0].samples, some[1].samples);
    }

    #[test]
    fn the_muscle_follows_its_label_by_the_lag() {
        for label_lag_ms in [150, 250, 400] {
            let options = SynthOptions {
                label_lag_ms,
                subjects: 8,
                ..SMALL
            };
            let recordings = generate(&options);
            let lag = lag::estimate(&recordings.iter().collect::<Vec<_>>()).unwrap();
            let found = lag.lag_samples as u32 * SAMPLE_PERIOD_MS;
            let is_near = found.abs_diff(label_lag_ms) <= 30;
            assert!(is_near, "{label_lag_ms}: {lag:?}");
        }
    }

    #[test]
    fn neighbouring_samples_correlate_as_real_ones() {
        let samples = &generate(&SMALL)[0].samples;
        let signal = samples.iter().map(|sample| f64::from(sample[3]) - BIAS);
        let signal: Vec<f64> = signal.collect();
        let power: f64 = signal.iter().map(|x| x * x).sum();
        let product: f64 = signal.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let correlation = product / power;
        assert!((-0.35..-0.15).contains(&correlation), "{correlation}");
    }
}
