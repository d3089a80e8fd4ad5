//! Simulated board: the firmware's own tasks in virtual time, on this machine.

mod events;

use std::fs;
use std::ops::Deref;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, ensure};
use shared::units::Sample;
use tempfile::TempDir;

pub use events::Start;

use crate::output::BoardOutput;

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
        events::read(&self.folder.path().join(events::EVENTS))
    }
}

impl Deref for Ran {
    type Target = BoardOutput;

    fn deref(&self) -> &BoardOutput {
        &self.output
    }
}

/// Runs a scenario to its end. `program` is what [`xtask::firmware::build_simulation`] built.
pub fn run(program: &Path, inputs: &Inputs<'_>) -> anyhow::Result<Ran> {
    let folder = tempfile::Builder::new().prefix("simulation").tempdir()?;
    let path = |name: &str| folder.path().join(name);
    fs::write(path("scenario.toml"), inputs.scenario)?;
    fs::write(path("model.intent"), inputs.model)?;
    let samples = bytemuck::cast_slice::<Sample, u8>(inputs.samples);
    fs::write(path("samples.i8"), samples)?;
    fs::write(path("page"), inputs.page)?;
    fs::write(path("calibration"), inputs.calibration)?;
    let mut board = Command::new(program);
    if let Some(file) = inputs.install {
        fs::write(path("other.intent"), file)?;
        board.arg("--install").arg(path("other.intent"));
        board.arg("--journal").arg(path("journal"));
    }
    let ran = board
        .arg(path("scenario.toml"))
        .arg("--model")
        .arg(path("model.intent"))
        .arg("--samples")
        .arg(path("samples.i8"))
        .arg("--page")
        .arg(path("page"))
        .arg("--calibration")
        .arg(path("calibration"))
        .arg("--out")
        .arg(folder.path())
        .output()
        .with_context(|| program.display().to_string())?;
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
        region: fs::read(path("model.intent"))?,
        calibration: fs::read(path("calibration"))?,
        folder,
    })
}
