//! Preprocessing of raw EMG: a median of three over time, if the model was trained with it, then rectification.
//!
//! The median is taken of signed values, before rectification; a neighbour beyond either end of the
//! stream counts as 0. It needs the following sample, so the streaming form lags one sample and then
//! equals the form for whole recordings; without a median it lags as much, so that times do not depend on the model.
//! Source: ReactEMG's public code; `tests/golden` compares with its numbers. Why there are models without:
//! docs/decisions.md.

use super::alignment::Alignment;
use super::normalizer::rectified;
use crate::kernels::{Active, Kernels};
use crate::units::{CHANNELS, CleanSample, Sample};

/// Divisor from a preprocessed value to the model's input, 0 to 1.
pub const DIVISOR: u8 = 128;

/// The filter over time before rectification.
#[derive(
    Clone, Copy, PartialEq, Eq, Hash, Debug, Default, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Median {
    /// The median of a sample and its two neighbours, as in the paper.
    #[default]
    Three,
    /// No median: the sample itself.
    Off,
}

impl Median {
    /// Samples that it is taken of.
    #[must_use]
    pub const fn width(self) -> u8 {
        match self {
            Self::Three => 3,
            Self::Off => 1,
        }
    }

    /// The filter of that width, if there is one.
    #[must_use]
    pub const fn of_width(width: u8) -> Option<Self> {
        match width {
            3 => Some(Self::Three),
            1 => Some(Self::Off),
            _ => None,
        }
    }
}

/// Processing that a model requires between the armband and its input.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Preprocessing {
    /// Whether samples are normalized to the wearer before all else ([`Normalizer`](super::normalizer::Normalizer)).
    pub normalized: bool,
    /// The filter over time.
    pub median: Median,
}

/// Median and rectification, sample by sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Preprocessor {
    median: Median,
    before: Sample,
    pending: Option<Sample>,
}

impl Preprocessor {
    /// A preprocessor before the first sample.
    #[must_use]
    pub const fn new(median: Median) -> Self {
        Self {
            median,
            before: [0; CHANNELS],
            pending: None,
        }
    }

    /// Takes the next sample; returns the one before it, preprocessed. The first sample returns nothing.
    #[inline]
    pub fn push(&mut self, sample: Sample) -> Option<CleanSample> {
        let pending = self.pending.replace(sample)?;
        let clean = self.rectified(pending, sample);
        self.before = pending;
        Some(clean)
    }

    /// Electrodes in another order, as if all samples so far had come in it.
    pub(crate) fn rearrange(&mut self, alignment: Alignment) {
        self.before = alignment.apply(self.before);
        self.pending = self.pending.map(|sample| alignment.apply(sample));
    }

    /// Ends the stream: returns its last sample, if there is one, and starts a new stream.
    pub fn finish(&mut self) -> Option<CleanSample> {
        let ended = core::mem::replace(self, Self::new(self.median));
        Some(ended.rectified(ended.pending?, [0; CHANNELS]))
    }

    /// The sample after `before`, preprocessed.
    #[inline]
    fn rectified(&self, sample: Sample, after: Sample) -> CleanSample {
        match self.median {
            Median::Three => Active::rectified_median(self.before, sample, after),
            Median::Off => rectified(sample),
        }
    }
}

/// Preprocesses a whole recording, sample for sample.
pub fn clean<I: IntoIterator<Item = Sample>>(
    recording: I,
    median: Median,
) -> impl Iterator<Item = CleanSample> {
    let mut preprocessor = Preprocessor::new(median);
    recording
        .into_iter()
        .map(Some)
        .chain(core::iter::once(None))
        .filter_map(move |next| match next {
            Some(sample) => preprocessor.push(sample),
            None => preprocessor.finish(),
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    /// The definition, for one channel.
    fn naive(values: &[i8]) -> Vec<u8> {
        let at = |place: isize| {
            usize::try_from(place).map_or(0, |place| values.get(place).copied().unwrap_or(0))
        };
        (0..values.len() as isize)
            .map(|place| {
                let mut three = [at(place - 1), at(place), at(place + 1)];
                three.sort_unstable();
                three[1].unsigned_abs()
            })
            .collect()
    }

    /// Magnitudes without a median.
    fn sizes(values: &[i8]) -> Vec<u8> {
        values.iter().map(|value| value.unsigned_abs()).collect()
    }

    #[test]
    fn a_width_is_that_of_one_filter() {
        for median in [Median::Three, Median::Off] {
            assert_eq!(Median::of_width(median.width()), Some(median));
        }
        assert_eq!([0, 2, 4, 255].map(Median::of_width), [None; 4]);
    }

    #[test]
    fn after_finish_a_new_stream_starts() {
        for (median, last) in [(Median::Three, 0), (Median::Off, 9)] {
            let mut preprocessor = Preprocessor::new(median);
            assert_eq!(preprocessor.finish(), None);
            assert_eq!(preprocessor.push([9; CHANNELS]), None);
            assert_eq!(preprocessor.finish(), Some([last; CHANNELS]));
            assert_eq!(preprocessor, Preprocessor::new(median));
        }
    }

    proptest! {
        #[test]
        fn the_stream_gives_what_the_whole_recording_gives(samples: Vec<Sample>) {
            for (median, naive) in [(Median::Three, naive as fn(&[i8]) -> Vec<u8>), (Median::Off, sizes)] {
                let output: Vec<_> = clean(samples.iter().copied(), median).collect();
                prop_assert_eq!(output.len(), samples.len());
                for channel in 0..CHANNELS {
                    let values: Vec<_> = samples.iter().map(|sample| sample[channel]).collect();
                    let found: Vec<_> = output.iter().map(|sample| sample[channel]).collect();
                    prop_assert_eq!(found, naive(&values));
                }
            }
        }
    }
}
