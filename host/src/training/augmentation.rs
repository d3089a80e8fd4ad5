//! Data augmentation for training, and samples as a model's input.

use rand::{RngExt, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, LogNormal, StandardNormal};
use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, CleanSample};

/// Random variation of training examples: how somebody else wears the armband.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Augmentation {
    /// Standard deviation of the natural logarithm of the gain, which is drawn once per example; 0: no gain.
    pub gain: f64,
    /// Largest rotation of the electrodes, in electrodes, in either direction.
    pub rotation: usize,
    /// Largest further rotation, in parts of the distance of two electrodes, in either direction: amplitudes in between
    /// are interpolated.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shift: f64,
    /// As `gain`, for each electrode by itself: contact with the skin, fat below it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub electrode_gain: f64,
    /// Probability that one electrode, drawn at random, is silent.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub silent_electrode: f64,
    /// Largest standard deviation, in counts, of noise added to every sample; it is drawn once per example.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub noise: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// One draw of an augmentation, applied to a whole window or sequence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variation {
    /// Gain of each electrode, after the rotation.
    gains: [f32; CHANNELS],
    rotation: usize,
    /// Share of the next electrode (of the one before, if negative) in each electrode's amplitude.
    shift: f32,
    noise: Option<Noise>,
}

/// Noise on every sample.
#[derive(Clone, Copy, Debug)]
struct Noise {
    /// Standard deviation, in counts / 128.
    deviation: f32,
    seed: u64,
}

impl Variation {
    /// No change: gain 1, no rotation.
    pub(crate) const NONE: Self = Self {
        gains: [1.0; CHANNELS],
        rotation: 0,
        shift: 0.0,
        noise: None,
    };
}

impl Augmentation {
    /// Draws a variation. What is 0 draws nothing.
    ///
    /// # Panics
    /// Never: a preset with a negative or infinite gain is refused when it is read.
    pub(crate) fn draw(&self, rng: &mut impl RngExt) -> Variation {
        let common = gain(self.gain, rng);
        let places = rng.random_range(0..=2 * self.rotation);
        let mut gains = std::array::from_fn(|_| common * gain(self.electrode_gain, rng));
        if self.silent_electrode > 0.0 && rng.random_bool(self.silent_electrode) {
            gains[rng.random_range(0..CHANNELS)] = 0.0;
        }
        let shift = if self.shift > 0.0 {
            rng.random_range(-self.shift..=self.shift) as f32
        } else {
            0.0
        };
        let noise = (self.noise > 0.0).then(|| Noise {
            deviation: rng.random_range(0.0..=self.noise) as f32 / 128.0,
            seed: rng.random(),
        });
        Variation {
            gains,
            rotation: (places + CHANNELS - self.rotation) % CHANNELS,
            shift,
            noise,
        }
    }
}

/// A gain with this deviation of its logarithm.
fn gain(deviation: f64, rng: &mut impl RngExt) -> f32 {
    if deviation > 0.0 {
        let gains = LogNormal::new(0.0, deviation).expect("presets hold a finite gain >= 0");
        gains.sample(rng) as f32
    } else {
        1.0
    }
}

impl Variation {
    /// Appends samples as a model's input: value / 128 times the gain, at most 1, channel after channel.
    pub(crate) fn write(self, samples: &[CleanSample], input: &mut Vec<f32>) {
        let mut noise = self
            .noise
            .map(|noise| (noise.deviation, ChaCha8Rng::seed_from_u64(noise.seed)));
        let neighbour = if self.shift < 0.0 { CHANNELS - 1 } else { 1 };
        let share = self.shift.abs();
        for sample in samples {
            for channel in 0..CHANNELS {
                let of = |place: usize| f32::from(sample[place % CHANNELS]) / 128.0;
                let place = channel + self.rotation;
                let mut value = of(place);
                if share > 0.0 {
                    value += share * (of(place + neighbour) - value);
                }
                value *= self.gains[channel];
                if let Some((deviation, rng)) = &mut noise {
                    // The sign of the EMG is lost, but noise has either sign as often.
                    let added: f32 = StandardNormal.sample(rng);
                    value = (value + *deviation * added).abs();
                }
                input.push(value.min(1.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(variation: Variation, sample: CleanSample) -> Vec<f32> {
        let mut input = Vec::new();
        variation.write(&[sample], &mut input);
        input
    }

    #[test]
    fn rotation_moves_channels_around_the_ring() {
        let variation = Variation {
            rotation: 7,
            ..Variation::NONE
        };
        let input = written(variation, [0, 16, 32, 48, 64, 80, 96, 128]);
        assert_eq!(input, [1.0, 0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75]);
    }

    #[test]
    fn gain_saturates_where_the_armband_does() {
        let variation = Variation {
            gains: [2.0; CHANNELS],
            ..Variation::NONE
        };
        let input = written(variation, [100, 10, 0, 0, 0, 0, 0, 0]);
        assert_eq!(input[..2], [1.0, 0.156_25]);
    }

    #[test]
    fn a_shift_is_between_two_electrodes() {
        let shifted = |shift| {
            let variation = Variation {
                shift,
                ..Variation::NONE
            };
            written(variation, [64, 0, 0, 0, 0, 0, 0, 32])
        };
        assert_eq!(shifted(0.25)[..2], [0.375, 0.0]);
        assert_eq!(shifted(0.25)[7], 0.25 * 0.75 + 0.5 * 0.25);
        assert_eq!(shifted(-0.25)[..2], [0.5 * 0.75 + 0.25 * 0.25, 0.125]);
        // A whole place is a rotation.
        let rotated = Variation {
            rotation: 1,
            ..Variation::NONE
        };
        assert_eq!(shifted(1.0), written(rotated, [64, 0, 0, 0, 0, 0, 0, 32]));
    }

    #[test]
    fn what_is_nought_draws_nothing() {
        let old = Augmentation {
            gain: 0.25,
            rotation: 1,
            ..Augmentation::default()
        };
        let (mut one, mut other) = (ChaCha8Rng::seed_from_u64(1), ChaCha8Rng::seed_from_u64(1));
        let variation = old.draw(&mut one);
        let expected = gain(0.25, &mut other);
        assert_eq!(variation.gains, [expected; CHANNELS]);
        let _: usize = other.random_range(0..=2);
        assert_eq!(one.random::<u64>(), other.random::<u64>());
    }

    #[test]
    fn electrodes_differ_one_is_silent_and_noise_has_its_deviation() {
        let worn = Augmentation {
            electrode_gain: 0.3,
            silent_electrode: 1.0,
            noise: 8.0,
            ..Augmentation::default()
        };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let variation = worn.draw(&mut rng);
        let silent = variation.gains.iter().filter(|&&gain| gain == 0.0).count();
        assert_eq!(silent, 1);
        let mut gains = variation.gains.to_vec();
        gains.sort_unstable_by(f32::total_cmp);
        gains.dedup();
        assert_eq!(gains.len(), CHANNELS);
        let mut input = Vec::new();
        variation.write(&[[0; CHANNELS]; 2000], &mut input);
        let mean_square = input.iter().map(|v| v * v).sum::<f32>() / input.len() as f32;
        let deviation = variation.noise.unwrap().deviation;
        assert!((0.0..=8.0 / 128.0).contains(&deviation));
        assert!((mean_square.sqrt() / deviation - 1.0).abs() < 0.05);
        let mut again = Vec::new();
        variation.write(&[[0; CHANNELS]; 2000], &mut again);
        assert_eq!(input, again);
    }
}
