//! Hours of a faulty armband in virtual time, through session, queue, pipeline and smoother.
//!
//! A run takes an hour by default; `MYOINTENT_SOAK_HOURS=24` sets a day, `MYOINTENT_SOAK_SEED=7` other faults and
//! clocks. The device's clock wraps ten minutes after the start, the position of samples after eight. The first
//! position counts as lost samples before it, so their counter stays at its maximum from some 96 000 on.

#[path = "soak/armband.rs"]
mod armband;
#[path = "soak/device.rs"]
mod device;
#[path = "soak/faults.rs"]
mod faults;
#[path = "soak/truth.rs"]
mod truth;

use armband::Armband;
use device::Device;
use faults::{Fault, Faults};

/// Seed of faults, delays and clocks unless another is given.
const SEED: u64 = 42;
/// Largest growth of the program's memory from the first minutes to the end, in KiB: less than a byte a notification of an
/// hour.
const GROWTH_KIB: u64 = 256;
const FIRST_MS: u64 = 900_000;

#[test]
fn hours_of_faults_leave_counters_true_and_no_label_without_a_full_window() {
    let hours = setting("MYOINTENT_SOAK_HOURS").unwrap_or(1);
    let seed = setting("MYOINTENT_SOAK_SEED").unwrap_or(SEED);
    let model = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/three-class.intent"
    ))
    .expect("the shipped model");
    let model = shared::model::Aligned(model);
    device::with_device(&model.0, |device| soak(device, hours, seed));
}

fn setting(name: &str) -> Option<u64> {
    let value = std::env::var(name).ok()?;
    Some(value.parse().unwrap_or_else(|_| panic!("{name}: a number")))
}

/// Runs so many hours and prints the counts.
fn soak(device: &mut Device<'_, '_>, hours: u64, seed: u64) {
    let mut faults = Faults::new(seed);
    let mut armband = Armband::new(device, seed);
    let mut first_kib = None;
    let mut incidents = 0;
    while armband.elapsed_ms() < hours * 3_600_000 {
        // The pause is long enough for a full window, and for the session to decide on late notifications.
        let clean = faults.pause();
        armband.stream(clean);
        armband.must_be_true();
        if armband.elapsed_ms() > FIRST_MS && first_kib.is_none() {
            first_kib = resident_kib();
        }
        let fault = faults.next();
        armband.suffer(fault);
        incidents += 1;
    }
    println!(
        "{hours} h, seed {seed}, {incidents} faults: {}",
        armband.summary()
    );
    let seen = armband.faults_seen();
    for kind in Fault::KINDS {
        assert!(seen.contains_key(kind), "{kind} never happened");
    }
    let (Some(first), Some(last)) = (first_kib, resident_kib()) else {
        return myointent_tests::skip("memory of the soak", "no /proc/self/status");
    };
    println!("{first} KiB of memory after a quarter of an hour, {last} KiB at the end");
    assert!(last <= first + GROWTH_KIB, "{first} KiB grew to {last} KiB");
}

/// Returns the resident memory in KiB; `None` where the system does not say.
fn resident_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}
