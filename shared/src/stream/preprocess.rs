//! From raw EMG to the model's input: median of three over time, then rectification.
//!
//! The median is taken of signed values, before rectification, and a neighbour beyond either end
//! of the stream counts as 0. It needs the sample that follows, so the streaming form lags one
//! sample; that buys equality with the form that sees a whole recording. Source: ReactEMG's public
//! code; held to its numbers in `tests/golden`.

use crate::units::{CHANNELS, CleanSample, Sample};

/// Samples under the median.
pub const MEDIAN_WIDTH: u8 = 3;
/// What a clean value is divided by to become the model's input, 0 ... 1.
pub const DIVISOR: u8 = 128;

/// Median and rectification, sample by sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Preprocessor {
    before: Sample,
    pending: Option<Sample>,
}

impl Preprocessor {
    /// At the start of a stream.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            before: [0; CHANNELS],
            pending: None,
        }
    }

    /// Takes the next sample; gives the one before it, clean. The first sample gives nothing yet.
    pub fn push(&mut self, sample: Sample) -> Option<CleanSample> {
        let pending = self.pending.replace(sample)?;
        let clean = rectified_median(self.before, pending, sample);
        self.before = pending;
        Some(clean)
    }

    /// Ends the stream: gives its last sample, if it had one, and starts anew.
    pub fn finish(&mut self) -> Option<CleanSample> {
        let ended = core::mem::take(self);
        let pending = ended.pending?;
        Some(rectified_median(ended.before, pending, [0; CHANNELS]))
    }
}

/// A whole recording, clean: as many samples as it has, each at its own place.
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

fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample {
    core::array::from_fn(|channel| {
        let (low, high) = (
            before[channel].min(after[channel]),
            before[channel].max(after[channel]),
        );
        here[channel].clamp(low, high).unsigned_abs()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    /// One channel of the rule as its source words it.
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
    fn beyond_either_end_lies_silence() {
        let output: Vec<_> = clean(every_channel(&[-5, 7, -9, 9])).collect();
        assert_eq!(output, [0, 5, 7, 0].map(|value| [value; CHANNELS]));
    }

    #[test]
    fn a_stream_that_was_finished_starts_anew() {
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
