//! What a run has written: files of its folder, which every call reads again.

use std::fmt::Write as _;

use anyhow::Context as _;
use serde_json::Value;
use shared::uart_line::Report;

use super::run::ARMBAND_LOG;
use super::{Pins, Run, machine};

/// Lines of each file in the message of a failure.
const TAIL: usize = 12;
/// Start of the first line that the program writes.
const STARTED: &str = "# myointent ";

impl Run {
    /// Complete lines of UART0 that are reports, line ends included.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let lines = self.file(machine::LABELS);
        let lines = lines.split_inclusive('\n').filter(|l| l.starts_with('$'));
        lines
            .filter(|l| l.ends_with('\n'))
            .map(str::to_owned)
            .collect()
    }

    /// Complete lines of UART0 that are comments, without line end.
    #[must_use]
    pub fn comments(&self) -> Vec<String> {
        let lines = self.file(machine::LABELS);
        let lines = lines.split_inclusive('\n').filter(|l| l.starts_with('#'));
        lines
            .filter(|l| l.ends_with('\n'))
            .map(|l| l.trim_end().to_owned())
            .collect()
    }

    /// The reports, parsed.
    ///
    /// # Errors
    /// When a line cannot be parsed.
    pub fn reports(&self) -> anyhow::Result<Vec<Report>> {
        let parse = |line: &String| Report::parse(line.as_bytes()).with_context(|| line.clone());
        self.lines().iter().map(parse).collect()
    }

    /// The reports after each start of the program, the newest start last.
    ///
    /// # Errors
    /// When a line is neither report nor comment, or comes before the first start.
    pub fn reports_by_start(&self) -> anyhow::Result<Vec<Vec<Report>>> {
        let mut starts: Vec<Vec<Report>> = Vec::new();
        let text = self.file(machine::LABELS);
        for line in text.split_inclusive('\n').filter(|l| l.ends_with('\n')) {
            if line.starts_with(STARTED) {
                starts.push(Vec::new());
            } else if !line.starts_with('#') {
                let reports = starts.last_mut();
                let reports = reports.with_context(|| format!("before the start: {line}"))?;
                reports.push(Report::parse(line.as_bytes()).with_context(|| line.to_owned())?);
            }
        }
        Ok(starts)
    }

    /// Every state of the pins.
    #[must_use]
    pub fn pins(&self) -> Vec<Pins> {
        let text = self.file(machine::PINS);
        let lines = text.split_inclusive('\n').filter(|l| l.ends_with('\n'));
        lines.filter_map(Pins::parse).collect()
    }

    /// The events in the armband's log.
    #[must_use]
    pub fn armband_events(&self) -> Vec<Value> {
        let text = self.file(ARMBAND_LOG);
        text.lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }

    /// How often an event is in the armband's log.
    #[must_use]
    pub fn event_count(&self, event: &str) -> usize {
        let events = self.armband_events();
        events.iter().filter(|line| line["event"] == event).count()
    }

    /// Bytes of the deepest stack so far.
    #[must_use]
    pub fn stack(&self) -> u64 {
        let text = self.file(machine::PINS);
        let used = text.lines().filter_map(|line| line.strip_prefix("STACK "));
        used.filter_map(|bytes| bytes.trim_end().parse().ok())
            .max()
            .unwrap_or(0)
    }

    /// When the faults were injected, by the guest's clock, in microseconds.
    #[must_use]
    pub fn faults_us(&self) -> Vec<u32> {
        let text = self.file(machine::PINS);
        let lines = text.split_inclusive('\n').filter(|l| l.ends_with('\n'));
        let times = lines.filter_map(|line| line.strip_prefix("FAULT "));
        times.filter_map(|us| us.trim_end().parse().ok()).collect()
    }

    fn file(&self, name: &str) -> String {
        // A file that does not exist yet is empty.
        let bytes = std::fs::read(self.folder.path().join(name)).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// The last lines of every file, for the message of a failure.
    #[must_use]
    pub fn tails(&self) -> String {
        let mut text = String::new();
        for name in [
            machine::LABELS,
            machine::PINS,
            "machine.out",
            ARMBAND_LOG,
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
