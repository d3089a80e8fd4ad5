//! One run: its processes, and waiting for what they write.

use std::io::Write as _;
use std::ops::Deref;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};
use bytemuck::cast_slice;
use tempfile::TempDir;
use virtual_armband::LINES;
use xtask::emulator;

use super::process::KillOnDrop;
use super::{Place, Python, Scenario};
use crate::output::{ARMBAND_LOG, BoardOutput};
use crate::simulation::{self, MODEL, PAGE, SAMPLES};

/// Longest wait. Far more than a healthy run needs, for a machine that is busy with other work.
const TIMEOUT: Duration = Duration::from_secs(90);
const POLL: Duration = Duration::from_millis(10);
/// Scenario without acts: the armband is another program, and the test is the person. The board runs for a day at most.
const SCENARIO: &str = "run_seconds = 86400\n";

/// Names of the socket and of the armband's script in the folder of a run.
const SOCKET: &str = "hci";
const SCRIPT: &str = "script.json";

/// A running board beside an armband. Both are killed when it is dropped.
pub struct Run {
    // Dropped first: a board that loses its controller would write an error.
    board: Option<KillOnDrop>,
    armband: KillOnDrop,
    folder: TempDir,
    output: BoardOutput,
    _place: Place,
}

impl Run {
    /// Starts an armband and a board.
    pub fn start(python: Python, scenario: &Scenario<'_>) -> anyhow::Result<Self> {
        // Short: the path of a socket has at most 107 bytes.
        let folder = tempfile::Builder::new().prefix("myo").tempdir()?;
        let path = |name: &str| folder.path().join(name);
        let script = scenario.script.to_string();
        let files = [
            (MODEL, scenario.model),
            (PAGE, &scenario.page[..]),
            (simulation::SCENARIO, SCENARIO.as_bytes()),
            (SAMPLES, cast_slice::<[i8; 8], u8>(scenario.samples)),
            (SCRIPT, script.as_bytes()),
            (LINES, &[]),
        ];
        for (name, contents) in files {
            std::fs::write(path(name), contents)?;
        }
        let mut armband = Command::new(&python.path);
        armband
            .arg(emulator::armband())
            .arg("--hci")
            .arg(format!("unix-server:{}", path(SOCKET).display()))
            .arg("--recording")
            .arg(path(SAMPLES))
            .arg("--script")
            .arg(path(SCRIPT))
            .arg("--log")
            .arg(path(ARMBAND_LOG))
            .args(["--pace", &scenario.pace.to_string()])
            .args(&scenario.arguments)
            // No cache of compiled modules among the sources.
            .env("PYTHONDONTWRITEBYTECODE", "1");
        let mut board = simulation::command(folder.path());
        board.args(["--slowed", &scenario.slowed.to_string()]);
        board.arg("--hci").arg(path(SOCKET));
        board.stdin(Stdio::piped());
        let mut run = Self {
            board: None,
            armband: KillOnDrop::start("armband", armband, folder.path())?,
            output: BoardOutput::new(folder.path()),
            folder,
            _place: python.place,
        };
        run.wait_for("the armband to be ready", |run| {
            run.event_count("ready") > 0
        })?;
        run.board = Some(KillOnDrop::start("board", board, run.folder.path())?);
        Ok(run)
    }

    pub fn send(&mut self, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
        let board = self.board.as_mut().context("no board")?;
        board.input()?.write_all(bytes.as_ref())?;
        Ok(())
    }

    /// The file that the armband streams; with its argument `--follow`, what is appended to it as well.
    pub fn recording(&self) -> PathBuf {
        self.folder.path().join(SAMPLES)
    }

    /// Sends a command and gives its answer's body. The answers to all commands before must have come.
    pub fn ask(&mut self, line: &str) -> anyhow::Result<String> {
        let before = self.answers().len();
        self.send(line)?;
        self.wait_for(&format!("an answer to {line}"), |run| {
            run.answers().len() > before
        })?;
        Ok(self.answers().swap_remove(before))
    }

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

    /// Says which process has ended. A board that resets itself ends.
    fn ended(&mut self) -> Option<String> {
        let mut processes = self.board.iter_mut().chain([&mut self.armband]);
        let ended = processes.find_map(KillOnDrop::ended);
        ended.map(|(name, status)| format!("the {name} ended ({status})"))
    }

    /// Checks the conditions that must hold in every run, whatever happened in it.
    pub fn check(&mut self) -> anyhow::Result<()> {
        let ended = self.ended();
        ensure!(ended.is_none(), "{ended:?}\n{}", self.tails());
        self.output.check(false)?;
        let is_late = self.comments().iter().any(|c| c.contains("too slow"));
        ensure!(!is_late, "packets were dropped\n{}", self.tails());
        let errors = self.event_count("error");
        ensure!(
            errors == 0,
            "{errors} errors of the armband\n{}",
            self.tails()
        );
        Ok(())
    }
}

impl Deref for Run {
    type Target = BoardOutput;

    fn deref(&self) -> &BoardOutput {
        &self.output
    }
}
