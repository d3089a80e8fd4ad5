//! The muscle activity of a synthetic recording: a person who wears the band and follows cues late.

use std::f64::consts::PI;
use std::ops::Range;

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use shared::intent::Intent;
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS, Sample};

/// Amplitude of rest, in counts.
const REST: f64 = 2.0;
/// Constant under all channels, as under the armband's.
pub(super) const BIAS: f64 = -1.0;
/// Weight of the previous innovation: neighbouring samples then correlate at -0.25.
const COLOUR: f64 = -0.268;
/// How much of an electrode's signal its neighbours on either side see.
const CROSSTALK: f64 = 0.2;
/// Ramps of the muscle, in samples: rising 60 to 160 ms, falling 100 to 260 ms.
const RISE: Range<usize> = 12..33;
const FALL: Range<usize> = 20..53;

fn normal(random: &mut impl Rng) -> f64 {
    StandardNormal.sample(random)
}

/// A person who wears the band.
pub(super) struct Wearer {
    /// Amplitude in counts by intent and electrode.
    patterns: [[f64; CHANNELS]; Intent::ALL.len()],
    /// From the cue to the start of the ramp, in samples.
    delay: f64,
}

impl Wearer {
    pub fn new(random: &mut impl Rng, label_lag_ms: u32) -> Self {
        let gain = (0.25 * normal(random)).exp();
        let rotation = random.random_range(-0.8..0.8);
        let patterns = Intent::ALL.map(|intent| {
            let activation: [f64; CHANNELS] = std::array::from_fn(|channel| {
                let own = (0.15 * normal(random)).exp();
                gain * own * activation(intent, channel as f64 + rotation)
            });
            std::array::from_fn(|channel| {
                let beside = activation[(channel + 1) % CHANNELS]
                    + activation[(channel + CHANNELS - 1) % CHANNELS];
                REST + activation[channel] + CROSSTALK * beside
            })
        });
        // Half of a mean ramp (about 32 samples either way) belongs to the lag.
        let lag = f64::from(label_lag_ms.clamp(100, 500)) / f64::from(SAMPLE_PERIOD_MS) - 14.0;
        Self {
            patterns,
            delay: (lag + 6.0 * normal(random)).max(0.0),
        }
    }

    /// Follows the cues; gives the samples and the intent that the muscle moves towards.
    pub fn perform(&self, cues: &[Intent], random: &mut impl Rng) -> (Vec<Sample>, Vec<Intent>) {
        let muscle = self.follow(cues, random);
        let mut samples = Vec::with_capacity(cues.len());
        let mut level = self.patterns[Intent::Relax.class()];
        let (mut from, mut since, mut ramp) = (level, 0, 1);
        let mut innovation = [0.0; CHANNELS];
        let mut tremor = 0.0;
        for (at, &intent) in muscle.iter().enumerate() {
            if at > 0 && muscle[at - 1] != intent {
                (from, since) = (level, 0);
                ramp = random.random_range(if intent == Intent::Relax { FALL } else { RISE });
            }
            since += 1;
            let risen = (since as f64 / ramp as f64).min(1.0);
            let share = 0.5 - 0.5 * (PI * risen).cos();
            // Fatigue: a quarter less after five seconds of holding, as in the recorded holds.
            let fatigue = 1.0 - 0.25 * (since as f64 / 1000.0).min(1.0);
            tremor = 0.97 * tremor + 0.04 * normal(random);
            let mut sample = [0; CHANNELS];
            for channel in 0..CHANNELS {
                let to = self.patterns[intent.class()][channel] * fatigue;
                level[channel] = from[channel] + share * (to - from[channel]);
                let fresh = normal(random);
                let noise = fresh + COLOUR * innovation[channel];
                innovation[channel] = fresh;
                let amplitude = level[channel] * (1.0 + tremor).max(0.2);
                sample[channel] = (BIAS + amplitude * noise).round().clamp(-128.0, 127.0) as i8;
            }
            samples.push(sample);
        }
        (samples, muscle)
    }

    /// The cues, every change later by this person's delay and some chance.
    fn follow(&self, cues: &[Intent], random: &mut impl Rng) -> Vec<Intent> {
        let mut muscle = cues.to_vec();
        for change in (1..cues.len()).filter(|&at| cues[at] != cues[at - 1]) {
            // Below the shortest run of cues, so that no change overtakes the next.
            let delay = (self.delay + 10.0 * normal(random)).clamp(0.0, 180.0) as usize;
            let end = (change + delay).min(cues.len());
            muscle[change..end].fill(cues[change - 1]);
        }
        muscle
    }
}

/// Amplitude of an intent at a position on the ring (electrodes 0..8), in counts.
fn activation(intent: Intent, position: f64) -> f64 {
    // Extensors lie around electrode 2, flexors around 6, the thumb's around 4.
    let bump = |centre: f64, width: f64| {
        let clockwise = (position - centre).rem_euclid(CHANNELS as f64);
        let distance = clockwise.min(CHANNELS as f64 - clockwise);
        (-0.5 * (distance / width).powi(2)).exp()
    };
    match intent {
        Intent::Relax => 0.0,
        Intent::Open => 24.0 * bump(3.0, 1.0) + 8.0 * bump(0.5, 0.8),
        Intent::Close => 26.0 * bump(6.5, 1.2) + 10.0 * bump(2.0, 0.8),
        Intent::WaveIn => 30.0 * bump(5.5, 0.8),
        Intent::WaveOut => 34.0 * bump(1.8, 0.9),
        Intent::Pinch => 14.0 * bump(4.5, 0.9) + 8.0 * bump(7.5, 0.7),
    }
}
