//! Data augmentation for training, and samples as a model's input.

use rand::RngExt;
use rand_distr::{Distribution, LogNormal};
use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, CleanSample};

/// Random variation of training examples: gain (how tightly the armband sits) and electrode rotation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Augmentation {
    /// Standard deviation of the natural logarithm of the gain, which is drawn once per example; 0: no gain.
    pub gain: f64,
    /// Largest rotation of the electrodes, in electrodes, in either direction.
    pub rotation: usize,
}

/// One draw of an augmentation, applied to a whole window or sequence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variation {
    gain: f32,
    rotation: usize,
}

impl Variation {
    /// No change: gain 1, no rotation.
    pub(crate) const NONE: Self = Self {
        gain: 1.0,
        rotation: 0,
    };
}

impl Augmentation {
    /// Draws a variation: the gain, then the rotation.
    ///
    /// # Panics
    /// Never: a preset with a negative or infinite gain is refused when it is read.
    pub(crate) fn draw(&self, rng: &mut impl RngExt) -> Variation {
        let gain = if self.gain > 0.0 {
            let gains = LogNormal::new(0.0, self.gain).expect("presets hold a finite gain >= 0");
            gains.sample(rng) as f32
        } else {
            1.0
        };
        let places = rng.random_range(0..=2 * self.rotation);
        Variation {
            gain,
            rotation: (places + CHANNELS - self.rotation) % CHANNELS,
        }
    }
}

impl Variation {
    /// Appends samples as a model's input: value / 128 times the gain, at most 1, channel after channel.
    pub(crate) fn write(self, samples: &[CleanSample], input: &mut Vec<f32>) {
        for sample in samples {
            for channel in 0..CHANNELS {
                let code = sample[(channel + self.rotation) % CHANNELS];
                input.push((f32::from(code) / 128.0 * self.gain).min(1.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_moves_channels_around_the_ring() {
        let mut input = Vec::new();
        Variation {
            gain: 1.0,
            rotation: 7,
        }
        .write(&[[0, 16, 32, 48, 64, 80, 96, 128]], &mut input);
        assert_eq!(input, [1.0, 0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75]);
    }

    #[test]
    fn gain_saturates_where_the_armband_does() {
        let mut input = Vec::new();
        Variation {
            gain: 2.0,
            rotation: 0,
        }
        .write(&[[100, 10, 0, 0, 0, 0, 0, 0]], &mut input);
        assert_eq!(input[..2], [1.0, 0.156_25]);
    }
}
