//! Simulated board, beyond scenarios: power and line cut at many places, and times from packet to pin and line.
//!
//! `MYOINTENT_CUTS=all` cuts at every place instead of a few that are drawn; `MYOINTENT_SEED` draws those of an earlier
//! run.

#[path = "simulated/cuts.rs"]
mod cuts;
#[path = "simulated/dialogues.rs"]
mod dialogues;
#[path = "simulated/latency.rs"]
mod latency;
#[path = "simulated/plan.rs"]
mod plan;
#[path = "simulated/power.rs"]
mod power;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use recordings::synthetic::{self, SynthOptions};
use shared::myo::Address;
use shared::myo::binding::to_record;
use shared::units::Sample;
use xtask::firmware;

/// Address of the armband.
const ARMBAND: &str = "FA:12:34:56:78:9A";

/// Returns the path of the simulated board's program, built once.
fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| firmware::build_simulation().unwrap())
}

/// Reads a model of the repository.
fn model(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    std::fs::read(folder.join(name).with_extension("intent")).unwrap()
}

/// Generates the armband's samples, of a synthetic person.
fn samples(seconds: usize) -> Vec<Sample> {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0).samples
}

/// Returns the page of a board that the armband is bound to.
fn page() -> Vec<u8> {
    to_record(Address::parse(ARMBAND).unwrap()).to_vec()
}
