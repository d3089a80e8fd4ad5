//! Golden checks that run on the host and on the emulated core, each a test here and, by [`ON_BOTH`], a test there;
//! recordings and the reference's input of golden/preprocess.

use std::array;
use std::fs;
use std::path::Path;

use checks::{
    Check,
    preprocess::{Input, Recording},
};
use myointent_tests::recorded;
use shared::units::{CHANNELS, Sample, WINDOW};

use crate::files::{checksum, json, npy};
use crate::smoother;

/// Name of the real recording. Its publishers state no licence, so the repository holds checksums of the reference's
/// numbers instead of the numbers.
const REAL: &str = "real_myo";
/// Path of the recording in the folder of recordings.
const REAL_FILE: &str = "one-subject-myo/stream/raw_emg.csv";

const RECORDINGS: [&str; 4] = ["synth_a", "synth_b", "synth_short", REAL];
/// Recordings that the reference processed in every other way too.
const SYNTHETIC: [&str; 2] = ["synth_a", "synth_b"];
/// Recordings of at least a window.
const LIVE: [&str; 3] = ["synth_a", "synth_b", REAL];

/// Reads recordings, each with the reference's file `NAME.processing.npy`.
fn recordings(golden: &Path, names: &[&str], processing: &str) -> Vec<Recording> {
    let folder = golden.join("preprocess");
    let stored = |name: &str| {
        let raw: Vec<i8> = npy(&folder.join(format!("{name}.raw.npy")));
        let expected: Vec<f32> = npy(&folder.join(format!("{name}.{processing}.npy")));
        let raw: Vec<Sample> = raw.as_chunks::<CHANNELS>().0.to_vec();
        (raw, expected.as_chunks::<CHANNELS>().0.to_vec())
    };
    let read = |&name: &&str| {
        let absent = name == REAL && !folder.join(format!("{name}.raw.npy")).exists();
        let (raw, expected) = match absent {
            true => real(golden, processing)?,
            false => stored(name),
        };
        Some(Recording {
            name: name.into(),
            raw,
            expected,
            stored_every: 1,
        })
    };
    names.iter().filter_map(read).collect()
}

/// Returns [`REAL`] and the reference's input; without it, prints which file is needed.
///
/// The input is computed by the rule in data/README.md; its checksum must be the reference's.
fn real(golden: &Path, processing: &str) -> Option<(Vec<Sample>, Vec<Input>)> {
    let text = fs::read_to_string(recorded(REAL_FILE)?).unwrap();
    let raw: Vec<Sample> = text.lines().map(row).collect();
    let index = json(&golden.join("preprocess/index.json"));
    let index = &index["recordings"][REAL];
    let counts = raw.as_flattened().iter();
    let bytes = counts.flat_map(|count| count.to_le_bytes());
    assert_eq!(index["fnv1a_64"]["raw"], checksum(bytes), "{REAL}");

    let expected: Vec<Input> = match processing {
        "train" => by_the_rule(&raw),
        "live_edges" => {
            let every = index["live"]["stored_every"].as_u64().unwrap() as usize;
            let edges = |window| {
                let window = by_the_rule(window);
                [window[0], window[WINDOW - 1]]
            };
            raw.windows(WINDOW).step_by(every).flat_map(edges).collect()
        }
        other => panic!("no checksum of {other}"),
    };
    let values = expected.as_flattened().iter();
    let found = checksum(values.flat_map(|value| value.to_le_bytes()));
    assert_eq!(index["fnv1a_64"][processing], found, "{REAL}, {processing}");
    Some((raw, expected))
}

fn row(line: &str) -> Sample {
    let mut numbers = line.split(',').map(|number| number.trim().parse().unwrap());
    array::from_fn(|_| numbers.next().unwrap())
}

/// Computes the centred median of three with zeros beyond the ends, then the absolute value as a share of 128.
fn by_the_rule(raw: &[Sample]) -> Vec<Input> {
    let at = |index: Option<usize>| index.and_then(|index| raw.get(index)).copied();
    let clean = |index: usize| {
        let [before, now, after] = [index.checked_sub(1), Some(index), Some(index + 1)]
            .map(|index| at(index).unwrap_or_default());
        array::from_fn(|channel| {
            let mut three = [before[channel], now[channel], after[channel]];
            three.sort_unstable();
            f32::from(three[1].unsigned_abs()) / 128.0
        })
    };
    (0..raw.len()).map(clean).collect()
}

pub fn whole(golden: &Path) -> Check {
    Check::WholeRecordings(recordings(golden, &RECORDINGS, "train"))
}

pub fn stream(golden: &Path) -> Check {
    Check::Stream(recordings(golden, &RECORDINGS, "train"))
}

pub fn rectified_first(golden: &Path) -> Check {
    Check::RectifiedFirst(recordings(golden, &SYNTHETIC, "after_rec"))
}

pub fn live_edges(golden: &Path) -> Check {
    let index = json(&golden.join("preprocess/index.json"));
    let mut recordings = recordings(golden, &LIVE, "live_edges");
    for recording in &mut recordings {
        let live = &index["recordings"][&recording.name]["live"];
        let inferences = live["inferences"].as_u64().unwrap() as usize;
        assert_eq!(recording.raw.windows(WINDOW).count(), inferences);
        recording.stored_every = live["stored_every"].as_u64().unwrap() as u32;
    }
    Check::LiveEdges(recordings)
}

/// Reads a check's data from the folder of reference numbers.
pub type Read = fn(&Path) -> Check;

macro_rules! on_both {
    ($($name:ident: $read:expr,)*) => {
        /// Names of the checks, and functions that read their data.
        pub const ON_BOTH: &[(&str, Read)] = &[$((stringify!($name), $read)),*];
        $(
            #[test]
            fn $name() {
                let listed = ON_BOTH.iter().find(|(name, _)| *name == stringify!($name));
                let (_, read) = listed.expect("every check is on the list");
                read(&myointent_tests::golden()).run();
            }
        )*
    };
}

on_both! {
    whole_recordings_become_the_reference_input: whole,
    the_stream_gives_the_reference_input_one_sample_late: stream,
    rectifying_first_is_the_other_variant: rectified_first,
    a_window_cleaned_by_itself_has_the_live_edges: live_edges,
    live_labels_are_the_references_in_every_case: smoother::live,
}
