//! Scenarios: a minute of an armband with its faults, and the expected behaviour of board, lines and pins.
//!
//! Every file of `tests/scenario` is a test on the simulated board in virtual time, and on the emulated board unless
//! its `simulation_only` says why not. README.md there describes the format.

#[path = "scenario/runner/bench.rs"]
mod bench;
#[path = "scenario/runner/expectation.rs"]
mod expectation;
#[path = "scenario/runner/file.rs"]
mod file;
#[path = "scenario/runner/installed.rs"]
mod installed;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use xtask::firmware;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenario");
    let trials = trials(&folder).unwrap_or_else(|error| {
        let message = format!("{error:#}");
        vec![Trial::test("scenarios_can_be_read", || Err(message.into()))]
    });
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trials(folder: &Path) -> anyhow::Result<Vec<Trial>> {
    let program: Arc<PathBuf> = Arc::new(firmware::build_simulation()?);
    let mut trials = Vec::new();
    for file in file::all(folder)? {
        if file.scenario.simulation_only.is_none() {
            let file = file.clone();
            trials.push(Trial::test(format!("emulator::{}", file.name), move || {
                bench::emulate(&file).map_err(|error| failed(&file, &error))
            }));
        }
        let program = Arc::clone(&program);
        trials.push(Trial::test(
            format!("simulation::{}", file.name),
            move || bench::simulate(&file, &program).map_err(|error| failed(&file, &error)),
        ));
    }
    Ok(trials)
}

fn failed(file: &file::File, error: &anyhow::Error) -> Failed {
    let about = &file.scenario.about;
    Failed::from(format!("{}: {about}\n{error:#}", file.path.display()))
}
