//! Firmware on the PC, its UART bridged to a pseudo-terminal: `live` shows what armband and board did.

use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use myointent::live::{self, Options, Source};
use myointent_tests::bench::{Bridge, Run, Scenario, python};
use serde_json::{Value, json};
use shared::myo::Address;
use shared::myo::binding::to_record;
use shared::uart_line::Report;

use super::viewer::Viewer;
use super::{shipped, synthetic};

/// Factor by which the board's clock runs slower than the PC's, so that a pause of a busy machine is short on it. The armband
/// streams at its own rate on that clock; the raw stream fits the line.
const SLOWED: u32 = 4;
const PACE: f64 = 0.25;
/// Longest wait on a machine that is busy with other work.
const PATIENCE: Duration = Duration::from_secs(120);

fn is(message: &Value, kind: &str) -> bool {
    message["type"] == kind
}

#[test]
fn the_firmware_is_shown_with_its_armbands_samples_and_its_own_labels() -> anyhow::Result<()> {
    let test = "the_firmware_is_shown_with_its_armbands_samples_and_its_own_labels";
    let Some(python) = python(test) else {
        return Ok(());
    };
    let samples = synthetic(60).samples;
    let armband = Address::parse("FA:12:34:56:78:9A")?;
    let scenario = Scenario {
        model: &shipped(),
        page: to_record(armband).to_vec(),
        samples: &samples,
        slowed: SLOWED,
        pace: PACE,
        script: json!([]),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    };
    let bridge = Bridge::start(Run::start(python, &scenario)?)?;
    let live = live::start(Options {
        source: Source::Port(bridge.port().to_owned()),
        model: Some(shipped()),
        listen: "127.0.0.1:0".parse()?,
        imu: false,
        record: None,
    })?;
    let mut viewer = Viewer::connect(live.url());
    let (sender, messages) = channel();
    let told = std::thread::spawn(move || {
        while let Some(message) = viewer.next() {
            let _ = sender.send(message);
        }
    });
    let mut seen = Vec::new();
    let mut until = |what: &str, is_it: &dyn Fn(&[Value]) -> bool| {
        let end = Instant::now() + PATIENCE;
        while !is_it(&seen) {
            anyhow::ensure!(Instant::now() < end, "no {what}\n{}", bridge.run().tails());
            seen.extend(messages.recv_timeout(Duration::from_millis(10)));
        }
        Ok(())
    };

    until("the board's name and its armband's", &|seen| {
        let known =
            |message: &Value| is(message, "board") && message["armband"] == "FA:12:34:56:78:9A";
        seen.iter().any(known)
    })?;
    until("scores, and labels of two seconds", &|seen| {
        let valid = |message: &&Value| is(message, "report") && message["valid"] == true;
        seen.iter().filter(valid).count() >= 20 && seen.iter().any(|message| is(message, "scores"))
    })?;

    let mut boards = seen.iter().filter(|message| is(message, "board"));
    let board = boards.next_back().unwrap();
    assert_eq!(
        (&board["image"], &board["battery"]),
        (&json!("simulated"), &json!(80))
    );
    let mut shown = 0;
    for message in seen.iter().filter(|message| is(message, "samples")) {
        let first = message["first"].as_u64().unwrap() as usize;
        assert_eq!(
            message["emg"],
            serde_json::to_value(&samples[first..first + 2])?
        );
        shown += 2;
    }
    assert!(shown > 400, "{shown}");
    let lines = bridge.run().lines();
    let mut compared = 0;
    for message in seen.iter().filter(|message| is(message, "report")) {
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
    let mut losses = seen.iter().filter(|message| is(message, "line"));
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
