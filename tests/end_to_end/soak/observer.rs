//! Observation of the armband and the board while a run goes on.

use std::collections::BTreeMap;

use anyhow::Context as _;
use myointent_tests::output::{Output, Tail};
use serde_json::Value;
use shared::uart_line::Report;

/// Milliseconds of the board after which a notification counts as held back by a busy host: the board may take such a
/// delay for a loss.
const LATE_MS: f64 = 25.0;
const PERIOD_MS: f64 = 10.0;

/// Reader of a run's files.
pub struct Observer {
    armband: Tail,
    lines: Tail,
    pins: Tail,
    time_scale: f64,
    /// Number of times that each event is in the armband's log.
    events: BTreeMap<String, u32>,
    /// Newest notification, and the time at which it was sent.
    sent: Option<(usize, f64)>,
    /// EMG notifications that the board has to receive, each time they come.
    on_air: u32,
    /// Number of times that the next notification counts as received, if the script impairs it.
    impaired: Option<i64>,
    /// True if the next notification is late because of the script, or first in its stream.
    excused: bool,
    /// Notifications that a busy host held back.
    late: u32,
    labels: u32,
    /// Sample at which the newest label was emitted.
    emitted: u32,
    stack: u64,
}

/// Counts of all observations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Number of connections of the armband.
    pub connections: u32,
    /// Number of connections that it closed at once.
    pub refusals: u32,
    /// Number of EMG notifications that the board has to receive, each time they come.
    pub on_air: u32,
    /// Number of notifications that a busy host held back.
    pub late: u32,
    /// Number of `$LABEL` lines.
    pub labels: u32,
    /// Sample at which the newest of them was emitted.
    pub emitted: u32,
    /// Bytes of the deepest stack.
    pub stack: u64,
}

impl Observer {
    /// Creates an observer of a run whose board's clock is `time_scale` times slower than real time.
    pub fn new(output: &Output, time_scale: u32) -> Self {
        Self {
            armband: output.follow_armband(),
            lines: output.follow_lines(),
            pins: output.follow_pins(),
            time_scale: time_scale.into(),
            events: BTreeMap::new(),
            sent: None,
            on_air: 0,
            impaired: None,
            excused: true,
            late: 0,
            labels: 0,
            emitted: 0,
            stack: 0,
        }
    }

    /// Reads what was written since the last call.
    pub fn read(&mut self) -> anyhow::Result<()> {
        for line in self.armband.lines()? {
            let event: Value = serde_json::from_str(&line).with_context(|| line.clone())?;
            self.event(&event).with_context(|| line.clone())?;
        }
        for line in self.lines.lines()? {
            if line.starts_with("$LABEL,") {
                let report = Report::parse(format!("{line}\r\n").as_bytes());
                self.emitted = report.with_context(|| line.clone())?.emitted.0;
                self.labels += 1;
            }
        }
        for line in self.pins.lines()? {
            if let Some(bytes) = line.strip_prefix("STACK ") {
                self.stack = self.stack.max(bytes.trim_end().parse()?);
            }
        }
        Ok(())
    }

    fn event(&mut self, event: &Value) -> anyhow::Result<()> {
        let name = event["event"].as_str().context("no event")?;
        *self.events.entry(name.to_owned()).or_default() += 1;
        match name {
            // The notification counts as received zero, one or two times.
            "drop" => self.impaired = Some(0),
            "duplicate" => self.impaired = Some(2),
            "corrupt" if event["kind"] != "long" => self.impaired = Some(0),
            "delay" | "mode" => self.excused = true,
            "sent" => {
                let n = event["n"].as_u64().context("no number")? as usize;
                let t = event["t"].as_f64().context("no time")?;
                let before = self.sent.replace((n, t));
                let passed = before.map_or(0.0, |(_, before)| 1000.0 * (t - before));
                let excused = std::mem::take(&mut self.excused);
                if !excused && passed > (PERIOD_MS + LATE_MS) * self.time_scale {
                    self.late += 1;
                }
                self.on_air += self.impaired.take().unwrap_or(1) as u32;
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the number of notifications sent so far, including those that were dropped.
    pub fn sent(&self) -> usize {
        self.sent.map_or(0, |(n, _)| n + 1)
    }

    /// Returns true if the recording is over.
    pub fn has_ended(&self) -> bool {
        self.events.contains_key("end")
    }

    /// Returns the counts of what was seen so far.
    pub fn seen(&self) -> Seen {
        let count = |event: &str| self.events.get(event).copied().unwrap_or(0);
        Seen {
            connections: count("connected"),
            refusals: count("refused"),
            on_air: self.on_air,
            late: self.late,
            labels: self.labels,
            emitted: self.emitted,
            stack: self.stack,
        }
    }
}
