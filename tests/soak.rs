//! Hours of armband in virtual time, with faults, through session, queue, pipeline and smoother.
//!
//! An hour by default; `MYOINTENT_SOAK_HOURS=24` for a day. The clock wraps ten minutes after the start, the position of
//! samples after eight.

#[path = "soak/armband.rs"]
mod armband;
#[path = "soak/device.rs"]
mod device;
#[path = "soak/faults.rs"]
mod faults;

use armband::Armband;
use device::Device;
use faults::{Fault, Faults};

/// Seeds of the faults.
const SEED: u64 = 42;

#[test]
fn hours_of_faults_leave_counters_true_and_no_label_without_a_full_window() {
    let hours = std::env::var("MYOINTENT_SOAK_HOURS").map_or(1, |hours| {
        hours
            .parse()
            .expect("MYOINTENT_SOAK_HOURS: a number of hours")
    });
    let model = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/three-class.intent"
    ))
    .expect("the shipped model");
    let model = shared::model::Aligned(model);
    device::with_device(&model.0, |device| soak(device, hours));
}

/// Runs so many hours and prints what happened.
fn soak(device: &mut Device<'_, '_>, hours: u64) {
    let mut faults = Faults::new(SEED);
    let mut armband = Armband::new(device);
    while armband.elapsed_ms() < hours * 3_600_000 {
        // Long enough for a full window, and for whatever came late to be decided.
        let clean = faults.pause();
        armband.stream(clean);
        armband.must_be_valid();
        let fault = faults.next();
        armband.suffer(fault);
    }
    println!("{hours} h: {}", armband.summary());
    let seen = armband.faults_seen();
    for kind in Fault::KINDS {
        assert!(seen.contains_key(kind), "{kind} never happened");
    }
}
