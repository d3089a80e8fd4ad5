//! What training reads: cleaned EMG with labels, stream by stream.

use rand::RngExt;
use rand_distr::{Distribution, LogNormal};
use serde::{Deserialize, Serialize};
use shared::intent::{Intent, Vocabulary};
use shared::preprocess::clean;
use shared::units::{CHANNELS, CleanSample, PATCH, Sample};

/// One continuous stream: a recording, or pieces of one subject's recordings joined.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Samples as the armband sends them, 200 Hz: what most of the peers learn from.
    pub raw: Vec<Sample>,
    /// The same samples, cleaned.
    pub emg: Vec<CleanSample>,
    /// What the hand wants at each sample, within the vocabulary; none where nobody knows.
    pub labels: Vec<Option<Intent>>,
}

impl Stream {
    /// Cleans samples; one label each.
    #[must_use]
    pub fn new(raw: Vec<Sample>, labels: Vec<Option<Intent>>) -> Self {
        Self {
            emg: clean(raw.iter().copied()).collect(),
            raw,
            labels,
        }
    }
}

/// All streams of one side of a split.
#[derive(Clone, Debug)]
pub struct Corpus {
    /// The classes that labels are taken from.
    pub vocabulary: Vocabulary,
    /// The streams; order is part of a run's reproducibility.
    pub streams: Vec<Stream>,
}

impl Corpus {
    /// Seconds of EMG.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.streams
            .iter()
            .map(|stream| stream.emg.len())
            .sum::<usize>() as f64
            / 200.0
    }
}

/// How EMG amplitudes are compressed before the patch embedding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Companding {
    /// x
    Linear,
    /// sqrt(x): the step from rest to a weak gesture counts as much as that to a strong one.
    SquareRoot,
}

/// How training examples are varied: an armband sits tighter or looser, and turned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Augmentation {
    /// Standard deviation of the logarithm of a gain, one a window; 0 leaves the EMG as it is.
    pub gain: f64,
    /// Largest rotation of the electrodes, in places either way.
    pub rotation: usize,
}

/// One drawn variation, applied to a whole window or sequence.
#[derive(Clone, Copy, Debug)]
pub struct Variation {
    gain: f32,
    rotation: usize,
}

impl Variation {
    /// Leaves everything as it is.
    pub const NONE: Self = Self {
        gain: 1.0,
        rotation: 0,
    };
}

impl Augmentation {
    /// Draws a variation.
    ///
    /// # Panics
    /// Never: a preset with a negative or infinite gain is refused when it is read.
    pub fn draw(&self, rng: &mut impl RngExt) -> Variation {
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
    /// Writes samples as the model's input, value / 128 times the gain, at most 1.
    pub fn write(self, samples: &[CleanSample], input: &mut Vec<f32>) {
        for sample in samples {
            for channel in 0..CHANNELS {
                let code = sample[(channel + self.rotation) % CHANNELS];
                input.push((f32::from(code) / 128.0 * self.gain).min(1.0));
            }
        }
    }
}

/// The label of a patch: that of most of its samples, none if most have none.
#[must_use]
pub fn patch_label(labels: &[Option<Intent>]) -> Option<Intent> {
    Intent::ALL
        .into_iter()
        .map(|intent| {
            (
                labels
                    .iter()
                    .filter(|&&label| label == Some(intent))
                    .count(),
                intent,
            )
        })
        .filter(|&(count, _)| 2 * count > labels.len())
        .map(|(_, intent)| intent)
        .next()
}

/// Labels patch by patch, the last partial patch left out.
#[must_use]
pub fn patch_labels(labels: &[Option<Intent>]) -> Vec<Option<Intent>> {
    labels.chunks_exact(PATCH).map(patch_label).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_takes_the_label_of_its_majority() {
        let relax = Some(Intent::Relax);
        let close = Some(Intent::Close);
        let mut labels = [relax; 10];
        labels[..6].fill(close);
        assert_eq!(patch_label(&labels), close);
        labels[..5].fill(None);
        assert_eq!(patch_label(&labels), None);
    }

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
