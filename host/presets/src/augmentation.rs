//! Data augmentation for training, and samples as a model's input.

use rand::RngExt;
use rand_distr::{Distribution, LogNormal};
use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, CleanSample};

/// Random variation of training examples, as if somebody else wore the armband.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Augmentation {
    /// Standard deviation of the natural logarithm of the gain, which is drawn once per example; 0: no gain.
    pub gain: f64,
    /// Largest rotation of the electrodes, in electrodes, in either direction.
    pub rotation: usize,
}

/// One draw of an augmentation, applied to a whole window or sequence.
#[derive(Clone, Copy, Debug)]
pub struct Variation {
    gain: f32,
    rotation: usize,
}

impl Variation {
    /// No change: gain 1, no rotation.
    pub const NONE: Self = Self {
        gain: 1.0,
        rotation: 0,
    };
}

impl Augmentation {
    /// Draws a variation; a gain of deviation 0 draws nothing.
    ///
    /// # Panics
    /// Never: a preset with a negative or infinite gain is refused when it is read.
    pub fn draw(&self, rng: &mut impl RngExt) -> Variation {
        let gain = gain(self.gain, rng);
        let places = rng.random_range(0..=2 * self.rotation);
        Variation {
            gain,
            rotation: (places + CHANNELS - self.rotation) % CHANNELS,
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
    pub fn write(self, samples: &[CleanSample], input: &mut Vec<f32>) {
        for sample in samples {
            for channel in 0..CHANNELS {
                let value = f32::from(sample[(channel + self.rotation) % CHANNELS]) / 128.0;
                input.push((value * self.gain).min(1.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

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
            gain: 2.0,
            ..Variation::NONE
        };
        let input = written(variation, [100, 10, 0, 0, 0, 0, 0, 0]);
        assert_eq!(input[..2], [1.0, 0.156_25]);
    }

    #[test]
    fn gains_have_their_deviation_and_rotations_reach_both_ways() {
        let augmentation = Augmentation {
            gain: 0.25,
            rotation: 1,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let drawn: Vec<_> = (0..4000).map(|_| augmentation.draw(&mut rng)).collect();
        let squares = drawn.iter().map(|own| own.gain.ln().powi(2));
        let deviation = (squares.sum::<f32>() / drawn.len() as f32).sqrt();
        assert!((deviation - 0.25).abs() < 0.01, "{deviation}");
        for rotation in [7, 0, 1] {
            let count = drawn.iter().filter(|own| own.rotation == rotation).count();
            assert!((1200..1470).contains(&count), "{rotation}: {count}");
        }
        let still = Augmentation::default().draw(&mut rng);
        assert_eq!((still.gain, still.rotation), (1.0, 0));
    }
}
