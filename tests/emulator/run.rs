//! One run: its processes, its files, and waiting for what is to appear in them.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use bytemuck::cast_slice;
use serde_json::Value;
use shared::intent::Intent;
use shared::stream::safe_state::SILENCE_MS;
use shared::uart_line::{Kind, Report};
use tempfile::TempDir;
use xtask::{emulator, firmware::STACK_BUDGET, stack};

use super::machine::{self, Machine, Straps};
use super::process::Guarded;
use super::{Bench, Board, Pins, Scene};

/// No wait is longer. Far beyond what a healthy run needs, on a machine that does other work too.
const PATIENCE: Duration = Duration::from_secs(90);
const POLL: Duration = Duration::from_millis(10);
/// From the last byte to the pin: the silence, the sample's way in, and the wait for a busy core.
const SAFE_WITHIN_US: u32 = SILENCE_MS * 1000 + 25_000;
/// Lines of each file that a failure shows.
const TAIL: usize = 12;
/// How the first line of a start begins.
const STARTED: &str = "# myointent ";

/// Armband and machine at work. Both end when it is dropped.
pub struct Run {
    // Dropped first: a machine without its controller would complain.
    machine: Option<Machine>,
    armband: Option<Guarded>,
    folder: TempDir,
    image: PathBuf,
    /// Whether the board is to start anew.
    faulty: bool,
}

impl Run {
    pub(super) fn start(bench: &Bench, scene: &Scene<'_>) -> anyhow::Result<Self> {
        let mut run = Self::empty(&bench.board, scene.fault.is_some())?;
        let path = |name: &str| run.folder.path().join(name);
        let (recording, script) = (path("recording.i8"), path("script.json"));
        std::fs::write(&recording, cast_slice::<[i8; 8], u8>(scene.samples))?;
        std::fs::write(&script, scene.script.to_string())?;
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
            .arg(path("armband"))
            .args(["--pace", &scene.pace.to_string()])
            .args(&scene.arguments)
            // A cache of compiled modules has no place in the sources.
            .env("PYTHONDONTWRITEBYTECODE", "1");
        run.armband = Some(Guarded::start("armband", armband, run.folder.path())?);
        run.wait_for("the armband to be ready", |run| run.happened("ready") > 0)?;
        let folder = run.folder.path();
        let straps = Straps {
            time_scale: scene.time_scale,
            fault: scene.fault,
        };
        let machine = Machine::start(folder, &run.image, scene.model, straps, Some(&socket))?;
        run.machine = Some(machine);
        Ok(run)
    }

    pub(super) fn start_alone(board: &Board, model: &[u8]) -> anyhow::Result<Self> {
        let mut run = Self::empty(board, false)?;
        let straps = Straps {
            time_scale: 1,
            fault: None,
        };
        let machine = Machine::start(run.folder.path(), &run.image, model, straps, None)?;
        run.machine = Some(machine);
        Ok(run)
    }

    fn empty(board: &Board, faulty: bool) -> anyhow::Result<Self> {
        Ok(Self {
            machine: None,
            armband: None,
            // Short, for the path of a socket has 107 bytes at most.
            folder: tempfile::Builder::new().prefix("myo").tempdir()?,
            image: board.image.clone(),
            faulty,
        })
    }

    /// Whole lines of UART0 that are reports, line ends included.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let lines = self.file(machine::LABELS);
        let lines = lines.split_inclusive('\n').filter(|l| l.starts_with('$'));
        lines
            .filter(|l| l.ends_with('\n'))
            .map(str::to_owned)
            .collect()
    }

    /// Whole lines of UART0 that are remarks, without line end.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let lines = self.file(machine::LABELS);
        let lines = lines.split_inclusive('\n').filter(|l| l.starts_with('#'));
        lines
            .filter(|l| l.ends_with('\n'))
            .map(|l| l.trim_end().to_owned())
            .collect()
    }

    /// The reports that the lines are.
    ///
    /// # Errors
    /// Where a line is none.
    pub fn reports(&self) -> anyhow::Result<Vec<Report>> {
        let parse = |line: &String| Report::parse(line.as_bytes()).with_context(|| line.clone());
        self.lines().iter().map(parse).collect()
    }

    /// The reports of each time that the board started, the newest last.
    ///
    /// # Errors
    /// Where a line is neither report nor remark, or comes before the first start.
    pub fn lives(&self) -> anyhow::Result<Vec<Vec<Report>>> {
        let mut lives: Vec<Vec<Report>> = Vec::new();
        let text = self.file(machine::LABELS);
        for line in text.split_inclusive('\n').filter(|l| l.ends_with('\n')) {
            if line.starts_with(STARTED) {
                lives.push(Vec::new());
            } else if !line.starts_with('#') {
                let life = lives.last_mut();
                let life = life.with_context(|| format!("before the start: {line}"))?;
                life.push(Report::parse(line.as_bytes()).with_context(|| line.to_owned())?);
            }
        }
        Ok(lives)
    }

    /// Every state that the pins were in.
    #[must_use]
    pub fn pins(&self) -> Vec<Pins> {
        let text = self.file(machine::PINS);
        let lines = text.split_inclusive('\n').filter(|l| l.ends_with('\n'));
        lines.filter_map(Pins::parse).collect()
    }

    /// What the armband wrote down.
    #[must_use]
    pub fn armband_events(&self) -> Vec<Value> {
        let text = self.file("armband");
        text.lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }

    /// How often the armband wrote an event down.
    #[must_use]
    pub fn happened(&self, event: &str) -> usize {
        let events = self.armband_events();
        events.iter().filter(|line| line["event"] == event).count()
    }

    /// Waits until a condition holds.
    ///
    /// # Errors
    /// Where patience or a process ends before: with the tails of all files.
    pub fn wait_for(
        &mut self,
        what: &str,
        condition: impl Fn(&Self) -> bool,
    ) -> anyhow::Result<()> {
        let start = Instant::now();
        loop {
            // Asked first: what ended may have done all it had to.
            let ended = self.ended();
            if condition(self) {
                return Ok(());
            }
            if let Some(ended) = ended {
                bail!("{ended} while waiting for {what}\n{}", self.tails());
            }
            if start.elapsed() > PATIENCE {
                bail!("waited {PATIENCE:?} in vain for {what}\n{}", self.tails());
            }
            std::thread::sleep(POLL);
        }
    }

    /// Most bytes of stack that the program has used so far.
    #[must_use]
    pub fn stack(&self) -> u64 {
        let text = self.file(machine::PINS);
        let used = text.lines().filter_map(|line| line.strip_prefix("STACK "));
        used.filter_map(|bytes| bytes.trim_end().parse().ok())
            .max()
            .unwrap_or(0)
    }

    /// What must hold in every run, whatever happened in it.
    ///
    /// # Errors
    /// Tells a line that is damaged, missing or a label while `valid` is low; a start anew without
    /// a fault; a `valid` pin that fell too late; a pin but relax's that is high meanwhile; an
    /// inference that was too slow; a stack beyond its budget; and whatever the armband took for an
    /// error.
    pub fn check(&self) -> anyhow::Result<()> {
        stack::record(&self.image, self.stack())?;
        let fault = self.bad_line()?.or_else(|| self.bad_pin());
        let fault = fault.or_else(|| {
            if self.remarks().iter().any(|r| r.contains("too slow")) {
                return Some("the inference dropped packets".to_owned());
            }
            if self.stack() > STACK_BUDGET {
                return Some(format!("{} bytes of stack", self.stack()));
            }
            (self.happened("error") > 0).then(|| "the armband complains".to_owned())
        });
        match fault {
            Some(fault) => bail!("{fault}\n{}", self.tails()),
            None => Ok(()),
        }
    }

    fn bad_line(&self) -> anyhow::Result<Option<String>> {
        let lives = self.lives().with_context(|| self.tails())?;
        if lives.len() > 1 && !self.faulty {
            return Ok(Some("the board started anew".to_owned()));
        }
        let placed = lives.iter().flat_map(|reports| reports.iter().enumerate());
        for (place, report) in placed {
            if report.sequence as usize != place {
                return Ok(Some(format!(
                    "line {place} is numbered {}",
                    report.sequence
                )));
            }
            if report.kind == Kind::Label && !report.status.valid() {
                return Ok(Some(format!("a label while not valid: {report}")));
            }
        }
        Ok(None)
    }

    fn bad_pin(&self) -> Option<String> {
        let pins = self.pins();
        let high = |pins: &&Pins| !pins.valid && pins.high != [Intent::Relax];
        if let Some(high) = pins.iter().find(high) {
            return Some(format!("not valid, and not relax either: {high:?}"));
        }
        let late = |pair: &&[Pins]| {
            pair[0].valid && !pair[1].valid && pair[1].since_last_byte_us() > SAFE_WITHIN_US
        };
        let late = pins.windows(2).find(late)?;
        Some(format!("valid for too long after the last byte: {late:?}"))
    }

    fn ended(&mut self) -> Option<String> {
        let machine = self.machine.as_mut().and_then(|machine| machine.0.ended());
        let ended = machine.or_else(|| self.armband.as_mut().and_then(Guarded::ended));
        ended.map(|(name, status)| format!("the {name} ended ({status})"))
    }

    fn file(&self, name: &str) -> String {
        // Not there yet: nothing was written.
        let bytes = std::fs::read(self.folder.path().join(name)).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// The last lines of every file, for a person who has to find out what went wrong.
    #[must_use]
    pub fn tails(&self) -> String {
        let mut text = String::new();
        for name in [
            machine::LABELS,
            machine::PINS,
            "machine.out",
            "armband",
            "armband.out",
        ] {
            let file = self.file(name);
            let lines: Vec<_> = file.lines().collect();
            let tail = &lines[lines.len().saturating_sub(TAIL)..];
            let _ = writeln!(text, "--- {name}, {} lines", lines.len());
            for line in tail {
                let _ = writeln!(text, "{line}");
            }
        }
        text
    }
}
