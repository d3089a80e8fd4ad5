//! One run: its processes, and waiting for what they write.

use std::ops::Deref;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use bytemuck::cast_slice;
use tempfile::TempDir;
use xtask::emulator;

use super::machine::Machine;
use super::process::KillOnDrop;
use super::{Bench, Board, Scenario};
use crate::output::{ARMBAND_LOG, LINES, Output};

/// Longest wait. Far more than a healthy run needs, for a machine that is busy with other work.
const TIMEOUT: Duration = Duration::from_secs(90);
/// Name of the file with the samples that the armband streams.
const RECORDING: &str = "recording.i8";
const POLL: Duration = Duration::from_millis(10);

/// A running armband and machine. Both are killed when it is dropped.
pub struct Run {
    // Dropped first: a machine that loses its controller would write an error.
    machine: Option<Machine>,
    armband: Option<KillOnDrop>,
    pub(super) folder: TempDir,
    pub(super) image: PathBuf,
    /// Files that armband and machine write.
    pub(super) output: Output,
    /// True if the board may restart: it was reset.
    pub(super) may_restart: bool,
}

impl Run {
    pub(super) fn start(bench: &Bench, scenario: &Scenario<'_>) -> anyhow::Result<Self> {
        let mut run = Self::new(&bench.board)?;
        let path = |name: &str| run.folder.path().join(name);
        let (recording, script) = (path(RECORDING), path("script.json"));
        std::fs::write(&recording, cast_slice::<[i8; 8], u8>(scenario.samples))?;
        std::fs::write(&script, scenario.script.to_string())?;
        let socket = path("hci");
        let mut armband = Command::new(&bench.python);
        armband
            .arg(emulator::armband())
            .arg("--hci")
            .arg(format!("unix-server:{}", socket.display()))
            .arg("--recording")
            .arg(recording)
            .arg("--script")
            .arg(script)
            .arg("--log")
            .arg(path(ARMBAND_LOG))
            .args(["--pace", &scenario.pace.to_string()])
            .args(&scenario.arguments)
            // No cache of compiled modules among the sources.
            .env("PYTHONDONTWRITEBYTECODE", "1");
        run.armband = Some(KillOnDrop::start("armband", armband, run.folder.path())?);
        run.wait_for("the armband to be ready", |run| {
            run.event_count("ready") > 0
        })?;
        let folder = run.folder.path();
        let page = scenario.page.as_deref();
        let machine = Machine::start(
            folder,
            &run.image,
            Some(scenario.model),
            page,
            scenario.time_scale,
            Some(&socket),
        )?;
        run.machine = Some(machine);
        Ok(run)
    }

    pub(super) fn start_without_armband(board: &Board) -> anyhow::Result<Self> {
        let mut run = Self::new(board)?;
        let machine = Machine::start(run.folder.path(), &run.image, None, None, 1, None)?;
        run.machine = Some(machine);
        Ok(run)
    }

    /// Presses the button, or releases it.
    ///
    /// # Errors
    /// When the machine does not run.
    pub fn set_button(&mut self, is_down: bool) -> anyhow::Result<()> {
        let machine = self.machine.as_mut().context("no machine")?;
        machine.set_button(is_down)
    }

    /// Resets the board, in the middle of whatever it does. [`Run::check`] accepts that from here on.
    ///
    /// # Errors
    /// When the machine does not run.
    #[cfg(unix)]
    pub fn reset(&mut self) -> anyhow::Result<()> {
        self.may_restart = true;
        self.machine.as_ref().context("no machine")?.reset()
    }

    /// Sends bytes to the UART that takes commands.
    ///
    /// # Errors
    /// When the machine does not run.
    pub fn send(&mut self, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
        let machine = self.machine.as_mut().context("no machine")?;
        machine.send(bytes.as_ref())
    }

    /// The file that the armband streams; with its argument `--follow`, what is appended to it as well.
    #[must_use]
    pub fn recording(&self) -> PathBuf {
        self.folder.path().join(RECORDING)
    }

    /// Opens the output of UART0 at its beginning; more comes while the machine runs.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open_labels(&self) -> anyhow::Result<std::fs::File> {
        Ok(std::fs::File::open(self.output.lines_file())?)
    }

    /// Sends a command and gives its answer's body. The answers to all commands before must have come.
    ///
    /// # Errors
    /// When none comes.
    pub fn ask(&mut self, line: &str) -> anyhow::Result<String> {
        let before = self.answers().len();
        self.send(line)?;
        self.wait_for(&format!("an answer to {line}"), |run| {
            run.answers().len() > before
        })?;
        Ok(self.answers().swap_remove(before))
    }

    fn new(board: &Board) -> anyhow::Result<Self> {
        // Short: the path of a socket has at most 107 bytes.
        let folder = tempfile::Builder::new().prefix("myo").tempdir()?;
        Ok(Self {
            machine: None,
            armband: None,
            output: Output::new(folder.path(), LINES),
            folder,
            image: board.image.clone(),
            may_restart: false,
        })
    }

    /// Waits until a condition holds.
    ///
    /// # Errors
    /// After a timeout, or when a process has ended; with the tails of all files.
    pub fn wait_for(
        &mut self,
        what: &str,
        condition: impl Fn(&Self) -> bool,
    ) -> anyhow::Result<()> {
        let start = Instant::now();
        loop {
            // Before the condition: a process that has ended may have fulfilled it.
            let ended = self.ended();
            if condition(self) {
                return Ok(());
            }
            if let Some(ended) = ended {
                bail!("{ended} while waiting for {what}\n{}", self.tails());
            }
            if start.elapsed() > TIMEOUT {
                bail!("waited {TIMEOUT:?} in vain for {what}\n{}", self.tails());
            }
            std::thread::sleep(POLL);
        }
    }

    fn ended(&mut self) -> Option<String> {
        let machine = self.machine.as_mut();
        let machine = machine.and_then(|machine| machine.process.ended());
        let ended = machine.or_else(|| self.armband.as_mut().and_then(KillOnDrop::ended));
        ended.map(|(name, status)| format!("the {name} ended ({status})"))
    }
}

impl Deref for Run {
    type Target = Output;

    fn deref(&self) -> &Output {
        &self.output
    }
}
