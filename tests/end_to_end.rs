//! Virtual armband -> controller -> HCI -> the firmware in an emulated Cortex-M4F -> label UART.
//!
//! Needs QEMU, the cross compiler and the armband's Python: `cargo xtask emulator --install`.

#[path = "end_to_end/armband.rs"]
mod armband;
#[path = "end_to_end/faults.rs"]
mod faults;
#[path = "end_to_end/misbehaviour.rs"]
mod misbehaviour;
#[path = "end_to_end/model.rs"]
mod model;
#[path = "end_to_end/recordings.rs"]
mod recordings;
#[path = "end_to_end/timing.rs"]
mod timing;

use std::path::PathBuf;

use shared::units::Sample;

/// The published model: the one that the README flashes.
fn model() -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/three-class.intent");
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The first seconds of a recording; without it, books the test as skipped.
fn samples(test: &str, recording: &str, seconds: usize) -> Option<Vec<Sample>> {
    let path = myointent_tests::data(test)?.join(recording);
    if !path.is_file() {
        myointent_tests::skip(test, &format!("no {}", path.display()));
        return None;
    }
    let recording = myointent::command::replay::one_recording(&path, None)
        .unwrap_or_else(|error| panic!("{}: {error:#}", path.display()));
    let mut samples = recording.samples;
    samples.truncate(seconds * 200);
    Some(samples)
}
