//! Simulated board: times from the packet that a label was made of to its pin, and to the last byte of its line; an
//! alignment; a calibration.

#[path = "simulated/alignment.rs"]
mod alignment;
#[path = "simulated/calibration.rs"]
mod calibration;

use myointent_tests::model_file;
use myointent_tests::simulation::{self, Inputs, Ran};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use recordings::synthetic::{self, SynthOptions};
use shared::myo::binding::to_record;
use shared::uart_line::{Report, ReportKind};
use virtual_armband::{ADDRESS, framed};

/// Returns the page of a board that the armband is bound to.
fn page() -> Vec<u8> {
    to_record(ADDRESS).to_vec()
}

/// Milliseconds of the packet that completes a patch, with every wait state that the nRF52840 may have
/// (docs/budgets.md). Here each packet takes as long.
const PACKET_MS: f64 = 3.7;
const SECONDS: usize = 100;

/// Number of commands sent beside the raw stream.
const ASKED: usize = 1200;

/// Times in microseconds, sorted.
struct Times(Vec<u64>);

impl Times {
    fn of(times: impl Iterator<Item = u64>) -> Self {
        let mut times: Vec<_> = times.collect();
        times.sort_unstable();
        Self(times)
    }

    fn median_ms(&self) -> f64 {
        self.0[self.0.len() / 2] as f64 / 1000.0
    }

    fn most_ms(&self) -> f64 {
        self.0[self.0.len() - 1] as f64 / 1000.0
    }
}

/// Runs a board in a stream, with a PC that sends a command every 70 ms at any moment between two packets.
fn stream(commands: &[&str]) -> Ran {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let sent = |(number, command): (usize, &&str)| {
        let at = 400 + 7 * number;
        // Bytes outside a line mean nothing, and take their time.
        let before = " ".repeat(random.random_range(0..100));
        let text = before + &framed(command);
        format!("{{ do = \"send-bytes\", at = {at}, text = {text:?} }},\n")
    };
    let person: String = commands.iter().enumerate().map(sent).collect();
    let text = format!(
        "run_seconds = {SECONDS}\npacket_ms = {PACKET_MS}\nend = \"disconnect\"\nperson = [\n{person}]\n"
    );
    let person = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: SECONDS - 10,
        ..SynthOptions::default()
    };
    let inputs = Inputs {
        scenario: &text,
        model: &model_file("three-class"),
        samples: &synthetic::generate(&person).remove(0).samples,
        page: &page(),
        calibration: &[],
        install: None,
    };
    simulation::run(&inputs).unwrap()
}

/// Returns the times from packet to pin, at changes of the label, and from packet to the end of the line. The first
/// label has no time of its line: it waits for the line that says valid.
fn times(ran: &Ran) -> (Times, Times) {
    ran.check(false).unwrap();
    let starts = ran.starts().unwrap();
    let [start] = &starts[..] else {
        panic!("it restarted");
    };
    let text = std::fs::read_to_string(ran.lines_file()).unwrap();
    let lines: Vec<_> = text.split_inclusive('\n').collect();
    assert_eq!(lines.len(), start.lines.len());
    // No packet is lost: the newest sample of a label is one of the two of this packet.
    let received = |report: &Report| {
        let number = report.emitted.0 as usize / 2;
        let (at, found) = start.packets[number];
        assert_eq!(found, number);
        at
    };
    let labels: Vec<_> = lines
        .iter()
        .zip(&start.lines)
        .filter_map(|(line, end)| {
            let report = Report::parse(line.as_bytes()).ok()?;
            (report.kind == ReportKind::Label).then_some((report, *end))
        })
        .collect();
    let line = Times::of(
        labels[1..]
            .iter()
            .map(|(report, end)| end - received(report)),
    );
    let changes = labels
        .windows(2)
        .filter(|pair| pair[0].0.status.label() != pair[1].0.status.label());
    let changes: Vec<_> = changes.map(|pair| pair[1].0).collect();
    let pins = ran.pins();
    let changed = pins
        .windows(2)
        .filter(|pair| pair[0].valid && pair[1].valid && pair[0].high != pair[1].high);
    let changed: Vec<_> = changed.map(|pair| &pair[1]).collect();
    assert_eq!(changed.len(), changes.len());
    let pin = changes.iter().zip(&changed).map(|(report, pins)| {
        assert_eq!(pins.high, [report.status.label()]);
        pins.at_us - received(report)
    });
    (Times::of(pin), line)
}

#[test]
fn from_packet_to_pin_and_line_a_label_takes_milliseconds_whatever_else_the_line_carries() {
    let alone = stream(&[]);
    let raw = stream(&["RAW,on"]);
    // The commands come more often than any page sends them; each answer is among the longest lines.
    let asked = ["IDENTIFY", "COUNTERS"].repeat(ASKED / 2);
    let asked = stream(&[&["RAW,on"], &asked[..]].concat());
    assert!(alone.emg().unwrap().is_empty());
    println!(
        "milliseconds: packet to pin, median and most; packet to the label's last byte, median and most; labels"
    );
    for (what, ran, most_of_line) in [
        ("labels alone", &alone, 10.0),
        ("raw stream", &raw, 15.0),
        ("raw stream, 14 commands a second", &asked, 25.0),
    ] {
        let (pin, line) = times(ran);
        let [a, b] = [pin.median_ms(), pin.most_ms()];
        let [c, d] = [line.median_ms(), line.most_ms()];
        println!(
            "{what}: {a:.2} {b:.2}; {c:.2} {d:.2}; {} changes, {} labels",
            pin.0.len(),
            line.0.len()
        );
        assert!(pin.0.len() > 20 && line.0.len() > 800);
        assert!(b < 6.0, "{what}: {b} ms to the pin");
        assert!(d < most_of_line, "{what}: {d} ms to the line's end");
        // No pin changes before the label is computed, and no line ends before its bytes are sent: 35 at least.
        assert!(pin.0[0] >= 3700 && line.0[0] >= 3700 + 35 * 86);
    }
    assert!(raw.emg().unwrap().len() > 8000);
    assert_eq!(asked.answers().len(), ASKED + 1);
}
