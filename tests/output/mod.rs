//! Output of a board, emulated or simulated: files of a folder, which every call reads again.

mod invariants;

use std::path::{Path, PathBuf};

use std::fmt::Write as _;

use anyhow::{Context as _, bail};
use serde_json::Value;
use shared::uart_line::{Report, alignment::AlignmentReport, emg::EmgReport, line::Line};
use virtual_armband::{LEVELS, LINES, PinLevels, framed};

/// Name of the armband's log of events.
pub const ARMBAND_LOG: &str = "armband";

/// Number of lines of each file in the message of a failure.
const TAIL: usize = 12;
/// Starts of the lines that are numbered together.
const NUMBERED: [&str; 3] = ["$LABEL,", "$STATE,", "$ALIGN,"];
/// Returns true if a line has a number: a label, a state, or a report of an alignment.
pub fn is_numbered(line: &str) -> bool {
    NUMBERED.iter().any(|start| line.starts_with(start))
}

/// Start of the first line that the program writes.
const STARTED: &str = "# myointent ";

/// Number of a line, and its report if it is a label or a state.
pub type NumberedLine = (u32, Option<Report>);

/// Reads a line that has a number.
pub fn numbered(line: &str) -> anyhow::Result<NumberedLine> {
    match Line::parse(line.as_bytes()).with_context(|| line.to_owned())? {
        Line::Report(report) => Ok((report.sequence, Some(report))),
        Line::Alignment(report) => Ok((report.sequence, None)),
        _ => bail!("{line}: expected a label, a state or an alignment"),
    }
}

/// Files of a board.
#[derive(Clone, Debug)]
pub struct BoardOutput {
    folder: PathBuf,
}

impl BoardOutput {
    /// Refers to the files in a folder.
    pub fn new(folder: &Path) -> Self {
        let folder = folder.to_owned();
        Self { folder }
    }

    /// Returns the path of the file with UART0's lines.
    pub fn lines_file(&self) -> PathBuf {
        self.folder.join(LINES)
    }

    /// Returns the complete lines of UART0 that are reports, line ends included.
    pub fn lines(&self) -> Vec<String> {
        self.complete(LINES, is_numbered)
    }

    /// Returns the bodies of the complete answers on UART0, each without `$`, checksum and line end.
    ///
    /// # Panics
    /// Panics if a checksum is wrong.
    pub fn answers(&self) -> Vec<String> {
        let is_answer = |line: &str| line.starts_with("$OK,") || line.starts_with("$ERR,");
        let body = |line: &String| {
            let text = line.trim_end().split_once('$');
            let body = text.and_then(|(_, rest)| rest.rsplit_once('*'));
            let (body, _) = body.unwrap_or_else(|| panic!("no checksum: {line}"));
            assert_eq!(*line, framed(body), "another checksum");
            body.to_owned()
        };
        self.complete(LINES, is_answer).iter().map(body).collect()
    }

    /// Returns the raw stream, parsed.
    pub fn emg(&self) -> anyhow::Result<Vec<EmgReport>> {
        let lines = self.complete(LINES, |line| line.starts_with("$EMG,"));
        let emg = |line: &String| match Line::parse(line.as_bytes()) {
            Ok(Line::Emg(report)) => Ok(report),
            other => bail!("{line}: {other:?}"),
        };
        lines.iter().map(emg).collect()
    }

    /// Returns the complete lines of UART0 that are comments, without line end.
    pub fn comments(&self) -> Vec<String> {
        let lines = self.complete(LINES, |line| line.starts_with('#'));
        lines
            .iter()
            .map(|line| line.trim_end().to_owned())
            .collect()
    }

    /// Returns labels and states, parsed.
    pub fn reports(&self) -> anyhow::Result<Vec<Report>> {
        let lines = self.lines();
        let reports = lines.iter().map(|line| Ok(numbered(line)?.1));
        reports.filter_map(Result::transpose).collect()
    }

    /// Returns the reports of alignments, parsed.
    pub fn alignments(&self) -> anyhow::Result<Vec<AlignmentReport>> {
        let lines = self.complete(LINES, |line| line.starts_with("$ALIGN,"));
        let alignment = |line: &String| match Line::parse(line.as_bytes()) {
            Ok(Line::Alignment(report)) => Ok(report),
            other => bail!("{line}: {other:?}"),
        };
        lines.iter().map(alignment).collect()
    }

    /// Returns the lines that have a number, as [`numbered`] reads them, after each start of the program, the newest start last.
    pub fn lines_by_start(&self) -> anyhow::Result<Vec<Vec<NumberedLine>>> {
        let mut starts: Vec<Vec<_>> = Vec::new();
        for line in self.complete(LINES, |_| true) {
            if line.starts_with(STARTED) {
                starts.push(Vec::new());
            } else if is_numbered(&line) {
                let lines = starts.last_mut();
                let lines = lines.with_context(|| format!("before the start: {line}"))?;
                lines.push(numbered(&line)?);
            }
        }
        Ok(starts)
    }

    /// Returns every state of the pins.
    pub fn pins(&self) -> Vec<PinLevels> {
        let lines = self.complete(LEVELS, |_| true);
        lines
            .iter()
            .filter_map(|line| PinLevels::parse(line))
            .collect()
    }

    /// Returns the events of this name in the armband's log.
    fn events(&self, name: &str) -> Vec<Value> {
        let text = self.file(ARMBAND_LOG);
        let events = text.lines().map(serde_json::from_str::<Value>);
        let events = events.filter_map(Result::ok);
        events.filter(|event| event["event"] == name).collect()
    }

    /// Returns the number of times that an event is in the armband's log.
    pub fn event_count(&self, name: &str) -> usize {
        self.events(name).len()
    }

    /// Returns the values of the virtual armband's events with this name.
    pub fn event_values(&self, name: &str) -> Vec<String> {
        let events = self.events(name);
        let values = events.iter().filter_map(|event| event["value"].as_str());
        values.map(str::to_owned).collect()
    }

    /// Returns the times at which the simulated armband began to stream, in microseconds; the virtual one does not log
    /// them.
    pub fn streams_us(&self) -> Vec<u64> {
        self.times_us("STREAM ")
    }

    /// Returns the times of the injected faults, in microseconds.
    pub fn faults_us(&self) -> Vec<u64> {
        self.times_us("FAULT ")
    }

    fn times_us(&self, what: &str) -> Vec<u64> {
        let lines = self.complete(LEVELS, |line| line.starts_with(what));
        let times = lines.iter().map(|line| line[what.len()..].trim_end());
        times.filter_map(|us| us.parse().ok()).collect()
    }

    /// Complete lines of a file, line ends included.
    fn complete(&self, name: &str, wanted: impl Fn(&str) -> bool) -> Vec<String> {
        let text = self.file(name);
        let lines = text
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n'));
        lines
            .filter(|line| wanted(line))
            .map(str::to_owned)
            .collect()
    }

    fn file(&self, name: &str) -> String {
        // A file that does not exist yet is empty.
        let bytes = std::fs::read(self.folder.join(name)).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Returns the last lines of every file, for the message of a failure.
    pub fn tails(&self) -> String {
        let mut text = String::new();
        for name in [LINES, LEVELS, "board.out", ARMBAND_LOG, "armband.out"] {
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
