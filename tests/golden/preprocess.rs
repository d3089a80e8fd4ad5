//! Median and rectification against golden/preprocess.

use std::path::Path;

use myointent_tests::golden;
use shared::preprocess::{ArmSide, DIVISOR, Preprocessor, clean};
use shared::units::{CHANNELS, CleanSample, Sample, WINDOW};

use crate::files::{json, npy};

const RECORDINGS: [&str; 4] = ["synth_a", "synth_b", "synth_short", "real_myo"];

fn raw(folder: &Path, recording: &str) -> Vec<Sample> {
    let values: Vec<i8> = npy(&folder.join(format!("{recording}.raw.npy")));
    values.as_chunks::<CHANNELS>().0.to_vec()
}

fn floats(folder: &Path, file: &str) -> Vec<[f32; CHANNELS]> {
    let values: Vec<f32> = npy(&folder.join(file));
    values.as_chunks::<CHANNELS>().0.to_vec()
}

fn scaled(sample: CleanSample) -> [f32; CHANNELS] {
    sample.map(|value| f32::from(value) / f32::from(DIVISOR))
}

#[test]
fn whole_recordings_become_the_reference_input() {
    let Some(golden) = golden("whole_recordings_become_the_reference_input") else {
        return;
    };
    let folder = golden.join("preprocess");
    for recording in RECORDINGS {
        let output: Vec<_> = clean(raw(&folder, recording)).map(scaled).collect();
        let expected = floats(&folder, &format!("{recording}.train.npy"));
        assert!(output == expected, "{recording} differs");
    }
}

#[test]
fn the_stream_gives_the_reference_input_one_sample_late() {
    let Some(golden) = golden("the_stream_gives_the_reference_input_one_sample_late") else {
        return;
    };
    let folder = golden.join("preprocess");
    for recording in RECORDINGS {
        let expected = floats(&folder, &format!("{recording}.train.npy"));
        let mut preprocessor = Preprocessor::new();
        for (index, sample) in raw(&folder, recording).into_iter().enumerate() {
            let given = preprocessor.push(sample).map(scaled);
            let before = index.checked_sub(1).map(|before| expected[before]);
            assert_eq!(given, before, "{recording}, sample {index}");
        }
        assert_eq!(preprocessor.finish().map(scaled), expected.last().copied());
    }
}

#[test]
fn a_left_arm_is_reordered_before_it_is_cleaned() {
    let Some(golden) = golden("a_left_arm_is_reordered_before_it_is_cleaned") else {
        return;
    };
    let folder = golden.join("preprocess");
    for recording in ["synth_a", "synth_b"] {
        let mirrored = raw(&folder, recording)
            .into_iter()
            .map(|sample| ArmSide::Left.reorder(sample));
        let output: Vec<_> = clean(mirrored).map(scaled).collect();
        let expected = floats(&folder, &format!("{recording}.left_hand.npy"));
        assert!(output == expected, "{recording} differs");
    }
}

/// The reference can also rectify before the median. It is no option here: the test shows that the
/// order of the two steps is understood, and that it matters.
#[test]
fn rectifying_first_is_the_other_variant() {
    let Some(golden) = golden("rectifying_first_is_the_other_variant") else {
        return;
    };
    let folder = golden.join("preprocess");
    for recording in ["synth_a", "synth_b"] {
        let raw = raw(&folder, recording);
        let size = |index: Option<usize>, channel: usize| {
            let sample = index.and_then(|index| raw.get(index));
            sample.map_or(0, |sample: &Sample| sample[channel].unsigned_abs())
        };
        let output: Vec<_> = (0..raw.len())
            .map(|index| {
                scaled(std::array::from_fn(|channel| {
                    let mut three = [index.checked_sub(1), Some(index), Some(index + 1)]
                        .map(|index| size(index, channel));
                    three.sort_unstable();
                    three[1]
                }))
            })
            .collect();
        let expected = floats(&folder, &format!("{recording}.after_rec.npy"));
        assert!(output == expected, "{recording} differs");
        assert!(output != floats(&folder, &format!("{recording}.train.npy")));
    }
}

/// The reference's live path cleans each window of raw samples by itself.
#[test]
fn a_window_cleaned_by_itself_has_the_live_edges() {
    let Some(golden) = golden("a_window_cleaned_by_itself_has_the_live_edges") else {
        return;
    };
    let folder = golden.join("preprocess");
    let index = json(&folder.join("index.json"));
    for recording in ["synth_a", "synth_b", "real_myo"] {
        let live = &index["recordings"][recording]["live"];
        let every = live["stored_every"].as_u64().unwrap() as usize;
        let raw = raw(&folder, recording);
        let edges: Vec<_> = raw
            .windows(WINDOW)
            .step_by(every)
            .flat_map(|window| {
                let window: Vec<_> = clean(window.iter().copied()).map(scaled).collect();
                [window[0], window[WINDOW - 1]]
            })
            .collect();
        let expected = floats(&folder, &format!("{recording}.live_edges.npy"));
        assert!(edges == expected, "{recording} differs");
        let inferences = live["inferences"].as_u64().unwrap() as usize;
        assert_eq!(raw.windows(WINDOW).count(), inferences);
    }
}
