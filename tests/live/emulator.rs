//! Firmware in the emulator, its UART bridged to a pseudo-terminal: `live` shows what armband and board did.

use std::io::Read as _;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use myointent::live::{self, Options, Source};
use myointent_tests::emulator::{Run, Scenario, bench};
use serde_json::{Value, json};
use serial2::SerialPort;
use shared::myo::Address;
use shared::myo::binding::to_record;
use shared::uart_line::Report;

use super::board::terminal;
use super::viewer::Viewer;
use super::{shipped, synthetic};

/// Factor by which the guest's clock runs slower than real time, so that a pause of a busy machine is short on it. The
/// armband streams at twice its real rate on that clock; the raw stream fits the line.
const TIME_SCALE: u32 = 5;
const PACE: f64 = 0.4;
/// Longest wait on a machine that is busy with other work.
const PATIENCE: Duration = Duration::from_secs(120);

/// Board in the emulator, and the board's end of a terminal.
struct Bridge {
    run: Run,
    labels: std::fs::File,
    line: SerialPort,
    messages: Receiver<Value>,
    seen: Vec<Value>,
}

impl Bridge {
    /// Carries bytes both ways until `is_it` holds of the messages seen.
    fn until(&mut self, what: &str, is_it: impl Fn(&[Value]) -> bool) -> anyhow::Result<()> {
        let end = Instant::now() + PATIENCE;
        while !is_it(&self.seen) {
            anyhow::ensure!(Instant::now() < end, "no {what}\n{}", self.run.tails());
            let mut bytes = Vec::new();
            self.labels.read_to_end(&mut bytes)?;
            self.line.write_all(&bytes)?;
            let mut buffer = [0; 256];
            if let Ok(length) = self.line.read(&mut buffer) {
                self.run.send(&buffer[..length])?;
            }
            self.seen.extend(self.messages.try_iter());
        }
        Ok(())
    }
}

fn is(message: &Value, kind: &str) -> bool {
    message["type"] == kind
}

#[test]
fn the_emulated_board_is_shown_with_its_armbands_samples_and_its_own_labels() -> anyhow::Result<()>
{
    let test = "the_emulated_board_is_shown_with_its_armbands_samples_and_its_own_labels";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = synthetic(60).samples;
    let armband = Address::parse("FA:12:34:56:78:9A")?;
    let run = bench.start(&Scenario {
        model: &shipped(),
        page: Some(to_record(armband).to_vec()),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        script: json!([]),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })?;
    let (mut line, slave) = SerialPort::pair()?;
    line.set_read_timeout(Duration::from_millis(2))?;
    let live = live::start(Options {
        source: Source::Port(terminal(&slave)),
        model: Some(shipped()),
        listen: "127.0.0.1:0".parse()?,
        record: None,
    })?;
    let mut viewer = Viewer::connect(live.url());
    let (sender, messages) = channel();
    let told = std::thread::spawn(move || {
        while let Some(message) = viewer.next() {
            let _ = sender.send(message);
        }
    });
    let mut bridge = Bridge {
        labels: run.open_labels()?,
        run,
        line,
        messages,
        seen: Vec::new(),
    };

    bridge.until("the board's name and its armband's", |seen| {
        let known =
            |message: &Value| is(message, "board") && message["armband"] == "FA:12:34:56:78:9A";
        seen.iter().any(known)
    })?;
    let mut boards = bridge.seen.iter().filter(|message| is(message, "board"));
    let board = boards.next_back().unwrap();
    assert_eq!(
        (&board["image"], &board["battery"]),
        (&json!("emulator"), &json!(80))
    );
    bridge.until("scores, and labels of two seconds", |seen| {
        let valid = |message: &&Value| is(message, "report") && message["valid"] == true;
        seen.iter().filter(valid).count() >= 20 && seen.iter().any(|message| is(message, "scores"))
    })?;

    let mut shown = 0;
    for message in bridge.seen.iter().filter(|message| is(message, "samples")) {
        let first = message["first"].as_u64().unwrap() as usize;
        assert_eq!(
            message["emg"],
            serde_json::to_value(&samples[first..first + 2])?
        );
        shown += 2;
    }
    assert!(shown > 400, "{shown}");
    let lines = bridge.run.lines();
    let mut compared = 0;
    for message in bridge.seen.iter().filter(|message| is(message, "report")) {
        let number = message["number"].as_u64().unwrap() as usize;
        let report = Report::parse(lines[number].as_bytes())?;
        assert_eq!(
            u64::from(report.instant.0),
            message["instant"].as_u64().unwrap()
        );
        assert_eq!(report.status.label().name(), message["label"]);
        assert_eq!(report.status.valid(), message["valid"] == true);
        compared += 1;
    }
    assert!(compared >= 20, "{compared}");
    let mut losses = bridge.seen.iter().filter(|message| is(message, "line"));
    let last = losses.next_back().unwrap();
    assert_eq!(
        (&last["damaged"], &last["missing"]),
        (&json!(0), &json!(0)),
        "{last}"
    );
    live.stop()?;
    told.join().unwrap();
    Ok(())
}
