//! From raw EMG to the model's input: median of three over time, then rectification.
//!
//! The median is taken of signed values, before rectification; a neighbour beyond either end of the
//! stream counts as 0. It needs the following sample, so the streaming form lags one sample and then
//! equals the form for whole recordings. Source: ReactEMG's public code; `tests/golden` compares with
//! its numbers.

use super::alignment::Alignment;
use crate::kernels::{Active, Kernels};
use crate::units::{CHANNELS, CleanSample, Sample};

/// Samples under the median.
pub(crate) const MEDIAN_WIDTH: u8 = 3;
/// Divisor from a preprocessed value to the model's input, 0 to 1.
pub const DIVISOR: u8 = 128;

/// Median and rectification, sample by sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Preprocessor {
    before: Sample,
    pending: Option<Sample>,
}

impl Preprocessor {
    /// Before the first sample.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            before: [0; CHANNELS],
            pending: None,
        }
    }

    /// Takes the next sample; returns the one before it, preprocessed. The first sample returns nothing.
    #[inline]
    pub fn push(&mut self, sample: Sample) -> Option<CleanSample> {
        let pending = self.pending.replace(sample)?;
        let clean = Active::rectified_median(self.before, pending, sample);
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
        let ended = core::mem::take(self);
        let pending = ended.pending?;
        Some(Active::rectified_median(
            ended.before,
            pending,
            [0; CHANNELS],
        ))
    }
}

/// Preprocesses a whole recording, sample for sample.
pub fn clean<I: IntoIterator<Item = Sample>>(recording: I) -> impl Iterator<Item = CleanSample> {
    let mut preprocessor = Preprocessor::new();
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

    fn every_channel(values: &[i8]) -> impl Iterator<Item = Sample> {
        values.iter().map(|value| [*value; CHANNELS])
    }

    #[test]
    fn the_most_negative_value_becomes_128() {
        let output: Vec<_> = clean(every_channel(&[-128, -128, -128])).collect();
        assert_eq!(output, [[128; CHANNELS]; 3]);
    }

    #[test]
    fn neighbours_beyond_either_end_are_zero() {
        let output: Vec<_> = clean(every_channel(&[-5, 7, -9, 9])).collect();
        assert_eq!(output, [0, 5, 7, 0].map(|value| [value; CHANNELS]));
    }

    #[test]
    fn after_finish_a_new_stream_starts() {
        let mut preprocessor = Preprocessor::new();
        assert_eq!(preprocessor.finish(), None);
        assert_eq!(preprocessor.push([9; CHANNELS]), None);
        assert_eq!(preprocessor.finish(), Some([0; CHANNELS]));
        assert_eq!(preprocessor, Preprocessor::new());
    }

    proptest! {
        #[test]
        fn the_stream_gives_what_the_whole_recording_gives(samples: Vec<Sample>) {
            let output: Vec<_> = clean(samples.iter().copied()).collect();
            prop_assert_eq!(output.len(), samples.len());
            for channel in 0..CHANNELS {
                let values: Vec<_> = samples.iter().map(|sample| sample[channel]).collect();
                let found: Vec<_> = output.iter().map(|sample| sample[channel]).collect();
                prop_assert_eq!(found, naive(&values));
            }
        }
    }
}
