//! Virtual armband -> controller -> HCI -> the firmware in an emulated Cortex-M4F -> label UART.
//!
//! Needs QEMU, the cross compiler and the armband's Python: `cargo xtask emulator --install`.

#[path = "end_to_end/alignment.rs"]
mod alignment;
#[path = "end_to_end/armband.rs"]
mod armband;
#[path = "end_to_end/binding.rs"]
mod binding;
#[path = "end_to_end/commands.rs"]
mod commands;
#[path = "end_to_end/faults.rs"]
mod faults;
#[cfg(target_os = "linux")]
#[path = "end_to_end/installation.rs"]
mod installation;
#[path = "end_to_end/model.rs"]
mod model;
#[path = "end_to_end/recordings.rs"]
mod recordings;
#[path = "end_to_end/soak.rs"]
mod soak;
#[path = "end_to_end/timing.rs"]
mod timing;

use std::path::PathBuf;

use myointent_tests::emulator::{Bench, Run, Scenario};
use serde_json::Value;
use shared::myo::Address;
use shared::myo::binding as record;
use shared::units::Sample;

/// Factor by which the guest's clock runs slower than real time. The timeout of 200 ms is then a second of real time,
/// and the delay of 35 ms that may mean four lost notifications is 175 ms: a busy host does not look like an armband
/// that is silent or lost data.
const TIME_SCALE: u32 = 5;
const PACE: f64 = 3.0;

/// Address of the virtual armband unless another one is given.
const ARMBAND: &str = "FA:12:34:56:78:9A";

/// Returns the page of a board to which the virtual armband is bound.
fn bound() -> Vec<u8> {
    let armband = Address::parse(ARMBAND).expect("an address");
    record::to_record(armband).to_vec()
}

/// Reads the model that the README flashes.
fn model() -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/three-class.intent");
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the file of a recording; without it, books the test as skipped and returns `None`.
fn recording(test: &str, recording: &str) -> Option<PathBuf> {
    let path = myointent_tests::data(test)?.join(recording);
    if !path.is_file() {
        let missing = format!("no {}: see docs/recordings.md", path.display());
        myointent_tests::skip(test, &missing);
        return None;
    }
    Some(path)
}

/// Reads the first seconds of a recording; without it, books the test as skipped and returns `None`.
fn samples(test: &str, recording: &str, seconds: usize) -> Option<Vec<Sample>> {
    let path = self::recording(test, recording)?;
    let recording = myointent::cli::replay::one_recording(&path, None)
        .unwrap_or_else(|error| panic!("{}: {error:#}", path.display()));
    let mut samples = recording.samples;
    samples.truncate(seconds * 200);
    Some(samples)
}

/// Streams to the end of the recording, where the armband disconnects.
fn play(
    bench: &Bench,
    model: &[u8],
    samples: &[Sample],
    time_scale: u32,
    script: Value,
) -> anyhow::Result<Run> {
    bench.start(&Scenario {
        model,
        page: Some(bound()),
        samples,
        time_scale,
        pace: PACE,
        fault: None,
        script,
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })
}
