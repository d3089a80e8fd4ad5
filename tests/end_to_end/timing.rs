//! Timing: on the guest's clock the armband streams at 200 Hz; both are slowed down by the same factor.

use myointent_tests::emulator::{Bench, Run, Scenario, bench};
use myointent_tests::output::Pins;
use serde_json::json;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;

/// Factor by which guest and armband run slower than real time.
const TIME_SCALE: u32 = 3;
const PACE: f64 = 1.0 / 3.0;

/// Counts how often `valid` fell. That it fell in time is checked in every run.
fn falls(run: &Run) -> usize {
    let pins = run.pins();
    let fell = |pair: &&[Pins]| pair[0].valid && !pair[1].valid;
    pins.windows(2).filter(fell).count()
}

fn last(run: &Run) -> Option<Report> {
    run.reports().ok()?.last().copied()
}

/// Plays samples at 200 Hz on the guest's clock.
fn play(
    test: &str,
    seconds: usize,
    script: serde_json::Value,
) -> anyhow::Result<Option<(Bench, Run)>> {
    let recording = "roshambo/data/subject02_session01_emg.npy";
    let Some(samples) = super::samples(test, recording, seconds) else {
        return Ok(None);
    };
    let Some(bench) = bench(test) else {
        return Ok(None);
    };
    let run = bench.start(&Scenario {
        model: &super::model(),
        page: Some(super::bound()),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        fault: None,
        script,
        arguments: Vec::new(),
    })?;
    Ok(Some((bench, run)))
}

fn wait_valid(run: &mut Run) -> anyhow::Result<()> {
    run.wait_for("a valid label", |run| {
        last(run).is_some_and(|report| report.status.valid())
    })
}

fn wait_silent(run: &mut Run) -> anyhow::Result<()> {
    run.wait_for("silence", |run| {
        last(run).is_some_and(|report| report.status.cause() == Some(Cause::Silence))
    })?;
    run.wait_for("the valid pin to fall", |run| {
        run.pins().last().is_some_and(|pins| !pins.valid)
    })
}

#[test]
fn a_stream_that_falls_silent_is_safe_within_200_ms_and_then_reconnected() -> anyhow::Result<()> {
    let test = "a_stream_that_falls_silent_is_safe_within_200_ms_and_then_reconnected";
    let Some((_bench, mut run)) = play(test, 4, json!([]))? else {
        return Ok(());
    };
    wait_valid(&mut run)?;
    wait_silent(&mut run)?;
    assert_eq!(falls(&run), 1, "{}", run.tails());
    assert_eq!(
        run.event_count("end"),
        1,
        "silent before the end\n{}",
        run.tails()
    );
    // The session writes the mode once more, then disconnects: the armband may have hung.
    run.wait_for("another connection", |run| {
        run.event_count("connected") == 2
    })?;
    run.check()
}

#[test]
fn after_a_pause_the_lost_are_counted_and_a_full_window_is_valid_again() -> anyhow::Result<()> {
    let test = "after_a_pause_the_lost_are_counted_and_a_full_window_is_valid_again";
    // 40 notifications are 400 ms.
    let script = json!([{"do": "drop", "at": 350, "count": 40}]);
    let Some((_bench, mut run)) = play(test, 8, script)? else {
        return Ok(());
    };
    wait_valid(&mut run)?;
    wait_silent(&mut run)?;
    wait_valid(&mut run)?;
    wait_silent(&mut run)?;
    assert_eq!(falls(&run), 2, "{}", run.tails());

    let reports = run.reports()?;
    let end = *reports.last().expect("reports");
    // The lanes show the loss modulo four notifications, the clock shows how many times four: on a busy host one time
    // too many or too few. Samples that arrived before the decision count as lost.
    let samples = 8 * 200;
    let off = end.emitted.0 as i32 + 1 - samples;
    assert!(
        off % 8 == 0 && off.abs() <= 8,
        "off by {off} samples\n{}",
        run.tails()
    );
    assert!((72..=112).contains(&end.counters.lost), "{end}");
    assert_eq!((end.counters.bridged, end.counters.resets), (0, 2), "{end}");
    let fallen = reports.iter().rposition(|report| report.status.valid());
    let silent = reports[..fallen.expect("valid")]
        .iter()
        .rfind(|report| report.status.cause() == Some(Cause::Silence))
        .expect("a silence between two valid states");
    let again = reports
        .iter()
        .find(|report| report.sequence > silent.sequence && report.status.valid());
    let passed = again.expect("valid again").emitted.since(silent.emitted);
    assert!(passed >= 600 + 72, "valid again after {passed} samples");
    run.check()
}
