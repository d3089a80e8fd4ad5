//! Where time itself matters: the guest hears the armband in real time, both slowed down alike.

use myointent_tests::emulator::{Run, Scene, bench};
use serde_json::json;
use shared::report_line::Report;
use shared::safe_state::{Cause, SILENCE_MS};

/// Guest and armband at half speed.
const TIME_SCALE: u32 = 2;
const PACE: f64 = 0.5;
/// From the last byte to the pin: the sample's way in, and the wait for a busy core.
const TOLERANCE_US: u32 = 25_000;

/// Every fall of `valid` comes no later than 200 ms after the last byte that the armband sent.
fn falls_in_time(run: &Run) -> usize {
    let pins = run.pins();
    let falls = pins
        .windows(2)
        .filter(|pair| pair[0].valid && !pair[1].valid);
    let falls: Vec<_> = falls.map(|pair| pair[1].clone()).collect();
    for fall in &falls {
        let after = fall.since_last_byte_us();
        let most = SILENCE_MS * 1000 + TOLERANCE_US;
        assert!(
            after <= most,
            "{after} us after the last byte\n{}",
            run.tails()
        );
    }
    falls.len()
}

fn last(run: &Run) -> Option<Report> {
    run.reports().ok()?.last().copied()
}

#[test]
fn a_stream_that_falls_silent_is_safe_within_200_ms() -> anyhow::Result<()> {
    let test = "a_stream_that_falls_silent_is_safe_within_200_ms";
    let recording = "roshambo/data/subject02_session01_emg.npy";
    let Some(samples) = super::samples(test, recording, 4) else {
        return Ok(());
    };
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let model = super::model();
    let mut run = bench.start(&Scene {
        model: &model,
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        script: json!([]),
        arguments: ["--end", "silence"].map(str::to_owned).to_vec(),
    })?;
    run.wait_for("a valid label", |run| {
        last(run).is_some_and(|r| r.status.valid())
    })?;
    run.wait_for("silence", |run| {
        last(run).is_some_and(|r| r.status.cause() == Some(Cause::Silence))
    })?;
    run.wait_for("the valid pin to fall", |run| {
        run.pins().last().is_some_and(|pins| !pins.valid)
    })?;
    assert_eq!(falls_in_time(&run), 1, "{}", run.tails());
    assert_eq!(
        run.happened("end"),
        1,
        "silent before the end\n{}",
        run.tails()
    );
    run.check()
}
