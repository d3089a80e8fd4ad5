//! Simulated board: the firmware's own tasks in virtual time, on this machine.

mod events;

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use anyhow::{Context as _, ensure};
use shared::units::Sample;
use tempfile::TempDir;
use virtual_armband::EVENTS;
use xtask::firmware;

pub use events::Start;

use crate::output::BoardOutput;

/// Names of files in a board's folder.
pub const SCENARIO: &str = "scenario.toml";
pub const MODEL: &str = "model.intent";
pub const SAMPLES: &str = "samples.i8";
pub const PAGE: &str = "page";
const CALIBRATION: &str = "calibration";

/// Returns the path of the board's program, built once.
///
/// # Panics
/// If it does not build.
fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    let build = || firmware::build_simulation().unwrap_or_else(|error| panic!("{error:#}"));
    PROGRAM.get_or_init(build)
}

/// Returns the command that runs a board on the files of a folder.
pub fn command(folder: &Path) -> Command {
    let mut board = Command::new(program());
    board.arg(folder.join(SCENARIO));
    for (option, name) in [
        ("--model", MODEL),
        ("--samples", SAMPLES),
        ("--page", PAGE),
        ("--journal", "journal"),
        ("--calibration", CALIBRATION),
        ("--out", ""),
    ] {
        board.arg(option).arg(folder.join(name));
    }
    board
}

/// Surroundings of a simulated board.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'s> {
    /// Text of the scenario, as `tests/scenario/README.md` describes it.
    pub scenario: &'s str,
    /// Content of the model's flash region, from its start.
    pub model: &'s [u8],
    pub samples: &'s [Sample],
    /// Content of the page of the bound armband, from its start.
    pub page: &'s [u8],
    /// Content of the calibration's page, from its start.
    pub calibration: &'s [u8],
    /// Model file that the person installs.
    pub install: Option<&'s [u8]>,
}

/// Output of a simulated board.
pub struct Ran {
    output: BoardOutput,
    /// Content of the model's flash region at the end.
    pub region: Vec<u8>,
    /// Content of the calibration's page at the end.
    pub calibration: Vec<u8>,
    folder: TempDir,
}

impl Ran {
    /// Returns the events after each start, with their times.
    pub fn starts(&self) -> anyhow::Result<Vec<Start>> {
        events::read(&self.folder.path().join(EVENTS))
    }
}

impl Deref for Ran {
    type Target = BoardOutput;

    fn deref(&self) -> &BoardOutput {
        &self.output
    }
}

/// Runs a scenario to its end.
pub fn run(inputs: &Inputs<'_>) -> anyhow::Result<Ran> {
    let folder = tempfile::Builder::new().prefix("simulation").tempdir()?;
    let path = |name: &str| folder.path().join(name);
    fs::write(path(SCENARIO), inputs.scenario)?;
    fs::write(path(MODEL), inputs.model)?;
    let samples = bytemuck::cast_slice::<Sample, u8>(inputs.samples);
    fs::write(path(SAMPLES), samples)?;
    fs::write(path(PAGE), inputs.page)?;
    fs::write(path(CALIBRATION), inputs.calibration)?;
    let mut board = command(folder.path());
    if let Some(file) = inputs.install {
        fs::write(path("other.intent"), file)?;
        board.arg("--install").arg(path("other.intent"));
    }
    let ran = board.output();
    let ran = ran.with_context(|| program().display().to_string())?;
    let output = BoardOutput::new(folder.path());
    ensure!(
        ran.status.success(),
        "{}: {}\n{}",
        ran.status,
        String::from_utf8_lossy(&ran.stderr),
        output.tails()
    );
    Ok(Ran {
        output,
        region: fs::read(path(MODEL))?,
        calibration: fs::read(path(CALIBRATION))?,
        folder,
    })
}
