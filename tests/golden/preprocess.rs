//! Recordings and the reference's input of golden/preprocess.

use std::path::Path;

use checks::{
    Check,
    preprocess::{Input, Recording},
};
use shared::units::{CHANNELS, WINDOW};

use crate::files::{json, npy};

const RECORDINGS: [&str; 4] = ["synth_a", "synth_b", "synth_short", "real_myo"];
/// Those that the reference processed in every other way too.
const SYNTHETIC: [&str; 2] = ["synth_a", "synth_b"];
/// Those of at least a window.
const LIVE: [&str; 3] = ["synth_a", "synth_b", "real_myo"];

/// Recordings beside the reference's file `NAME.processing.npy` of each.
fn recordings(golden: &Path, names: &[&str], processing: &str) -> Vec<Recording> {
    let folder = golden.join("preprocess");
    let read = |name: &&str| {
        let raw: Vec<i8> = npy(&folder.join(format!("{name}.raw.npy")));
        let expected: Vec<f32> = npy(&folder.join(format!("{name}.{processing}.npy")));
        let expected: Vec<Input> = expected.as_chunks::<CHANNELS>().0.to_vec();
        Recording {
            name: (*name).into(),
            raw: raw.as_chunks::<CHANNELS>().0.to_vec(),
            expected,
            stored_every: 1,
        }
    };
    names.iter().map(read).collect()
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
