//! Checks of median and rectification.

use alloc::{string::String, vec::Vec};

use serde::{Deserialize, Serialize};
use shared::stream::preprocess::{DIVISOR, Median, Preprocessor, clean};
use shared::units::{CHANNELS, CleanSample, Sample, WINDOW};

/// Input of the model at one instant, 0 ... 1.
pub type Input = [f32; CHANNELS];

/// Recording, and the reference's output.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Recording {
    /// Name in the reference's files.
    pub name: String,
    /// Samples as the armband sent them.
    pub raw: Vec<Sample>,
    /// The expected output.
    pub expected: Vec<Input>,
    /// Distance in windows between those that the reference stored; 1 if the check has no windows.
    pub stored_every: u32,
}

fn scaled(sample: CleanSample) -> Input {
    sample.map(|value| f32::from(value) / f32::from(DIVISOR))
}

fn cleaned(samples: impl IntoIterator<Item = Sample>) -> Vec<Input> {
    clean(samples, Median::Three).map(scaled).collect()
}

/// Asserts that a whole recording gives the reference's input.
pub fn whole(recording: &Recording) {
    let output = cleaned(recording.raw.iter().copied());
    assert!(output == recording.expected, "{} differs", recording.name);
}

/// Asserts that sample by sample the preprocessor gives the reference's input one sample late.
pub fn stream(recording: &Recording) {
    let Recording {
        name,
        raw,
        expected,
        ..
    } = recording;
    let mut preprocessor = Preprocessor::new(Median::Three);
    for (index, sample) in raw.iter().enumerate() {
        let given = preprocessor.push(*sample).map(scaled);
        let before = index.checked_sub(1).map(|before| expected[before]);
        assert_eq!(given, before, "{name}, sample {index}");
    }
    assert_eq!(preprocessor.finish().map(scaled), expected.last().copied());
}

/// Asserts that rectifying before the median gives the reference's output of that order, and another one than ours. The
/// preprocessor has no such option.
pub fn rectified_first(recording: &Recording) {
    let Recording {
        name,
        raw,
        expected,
        ..
    } = recording;
    let size = |index: Option<usize>, channel: usize| {
        let sample = index.and_then(|index| raw.get(index));
        sample.map_or(0, |sample: &Sample| sample[channel].unsigned_abs())
    };
    let output: Vec<_> = (0..raw.len())
        .map(|index| {
            scaled(core::array::from_fn(|channel| {
                let mut three = [index.checked_sub(1), Some(index), Some(index + 1)]
                    .map(|index| size(index, channel));
                three.sort_unstable();
                three[1]
            }))
        })
        .collect();
    assert!(output == *expected, "{name} differs");
    assert!(output != cleaned(raw.iter().copied()), "{name} is the same");
}

/// Compares the first and the last sample of every window that was stored. The reference's live path preprocesses each
/// window of raw samples by itself.
pub fn live_edges(recording: &Recording) {
    let edges: Vec<_> = recording
        .raw
        .windows(WINDOW)
        .step_by(recording.stored_every as usize)
        .flat_map(|window| {
            let window = cleaned(window.iter().copied());
            [window[0], window[WINDOW - 1]]
        })
        .collect();
    assert!(edges == recording.expected, "{} differs", recording.name);
}
