//! A misbehaving armband: errors show in the counters, or not at all, and never as a wrong label.
//!
//! The guest's clock is slow, so that losses are detected by lanes and bytes and not by time. The lines
//! are compared with those of the shared pipeline, run with what reached the device.

use myointent_tests::emulator::{Bench, Input, Run, Scenario, bench, expected_lines};
use serde_json::json;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::units::Sample;

use super::{PACE, TIME_SCALE, play};

const RECORDING: &str = "roshambo/data/subject02_session01_emg.npy";
/// The session's timeout of a connection attempt.
const CONNECT_US: u32 = 5_000_000;
/// Smaller than elsewhere: these runs mostly wait on the guest's clock.
const LINK_TIME_SCALE: u32 = 3;

/// Bench, model and the first seconds of a recording.
fn prepare(test: &str, seconds: usize) -> Option<(Bench, Vec<u8>, Vec<Sample>)> {
    let samples = super::samples(test, RECORDING, seconds)?;
    Some((bench(test)?, super::model(), samples))
}

/// Waits for as many lines as expected and compares them.
fn compare(run: &mut Run, expected: &[String]) -> anyhow::Result<()> {
    run.wait_for(&format!("{} lines", expected.len()), |run| {
        run.lines().len() >= expected.len()
    })?;
    let lines = run.lines();
    let differs = lines
        .iter()
        .zip(expected)
        .position(|(line, wanted)| line != wanted);
    if let Some(place) = differs {
        let (found, wanted) = (&lines[place], &expected[place]);
        panic!("line {place}: {found}expected: {wanted}{}", run.tails());
    }
    run.check()
}

/// The samples of notifications `from` to `to`.
fn of(samples: &[Sample], from: usize, to: usize) -> Input<'_> {
    Input::Samples(&samples[2 * from..2 * to])
}

#[test]
fn up_to_two_lost_notifications_are_bridged_and_three_reset_the_window() -> anyhow::Result<()> {
    let test = "up_to_two_lost_notifications_are_bridged_and_three_reset_the_window";
    let Some((bench, model, samples)) = prepare(test, 12) else {
        return Ok(());
    };
    let script = json!([
        {"do": "drop", "at": 400, "count": 1},
        {"do": "drop", "at": 500, "count": 2},
        {"do": "drop", "at": 601, "count": 3},
    ]);
    let mut run = play(&bench, &model, &samples, TIME_SCALE, script)?;
    let expected = expected_lines(
        &model,
        &[
            of(&samples, 0, 400),
            Input::Gap(2),
            of(&samples, 401, 500),
            Input::Gap(4),
            of(&samples, 502, 601),
            Input::Gap(6),
            of(&samples, 604, samples.len() / 2),
            Input::Disconnected,
        ],
    )?;
    compare(&mut run, &expected)?;
    let reports = run.reports()?;
    let last = reports.last().expect("lines").counters;
    assert_eq!((last.lost, last.bridged, last.resets), (12, 6, 2));
    recovers_with_a_full_window(&reports, Cause::Gap);
    Ok(())
}

/// After the state became safe for this cause, the next label needs 600 new samples.
fn recovers_with_a_full_window(reports: &[Report], cause: Cause) {
    let safe = reports
        .iter()
        .position(|report| report.status.cause() == Some(cause));
    let safe = safe.unwrap_or_else(|| panic!("never safe for {cause:?}"));
    let again = reports[safe..].iter().find(|report| report.status.valid());
    let again = again.unwrap_or_else(|| panic!("not valid again after {cause:?}"));
    let samples = again.emitted.since(reports[safe].emitted);
    assert!(samples >= 600, "valid again after {samples} samples");
}

#[test]
fn more_short_gaps_than_a_window_may_have_drop_valid() -> anyhow::Result<()> {
    let test = "more_short_gaps_than_a_window_may_have_drop_valid";
    let Some((bench, model, samples)) = prepare(test, 12) else {
        return Ok(());
    };
    // Every fourth notification for 1.2 s: at the end 31 gaps of two samples, where 30 may be bridged.
    let lost: Vec<usize> = (400..524).step_by(4).collect();
    let steps = lost
        .iter()
        .map(|at| json!({"do": "drop", "at": at, "count": 1}));
    let mut run = play(&bench, &model, &samples, TIME_SCALE, steps.collect())?;
    let mut inputs = vec![of(&samples, 0, lost[0])];
    for (place, at) in lost.iter().enumerate() {
        let next = lost.get(place + 1).copied().unwrap_or(samples.len() / 2);
        inputs.extend([Input::Gap(2), of(&samples, at + 1, next)]);
    }
    inputs.push(Input::Disconnected);
    compare(&mut run, &expected_lines(&model, &inputs)?)?;
    let reports = run.reports()?;
    let last = reports.last().expect("lines").counters;
    assert_eq!((last.lost, last.bridged, last.resets), (62, 60, 2));
    recovers_with_a_full_window(&reports, Cause::Losses);
    Ok(())
}

#[test]
fn duplicates_swaps_long_values_and_delays_change_no_line() -> anyhow::Result<()> {
    let test = "duplicates_swaps_long_values_and_delays_change_no_line";
    let Some((bench, model, samples)) = prepare(test, 6) else {
        return Ok(());
    };
    let script = json!([
        {"do": "duplicate", "at": 350},
        {"do": "swap", "at": 400},
        {"do": "corrupt", "at": 450, "kind": "long"},
        {"do": "delay", "at": 500, "ms": 300},
    ]);
    let mut run = play(&bench, &model, &samples, TIME_SCALE, script)?;
    let expected = expected_lines(&model, &[Input::Samples(&samples), Input::Disconnected])?;
    compare(&mut run, &expected)
}

#[test]
fn short_foreign_and_garbage_packets_count_as_lost() -> anyhow::Result<()> {
    let test = "short_foreign_and_garbage_packets_count_as_lost";
    let Some((bench, model, samples)) = prepare(test, 6) else {
        return Ok(());
    };
    let script = json!([
        {"do": "corrupt", "at": 350, "kind": "short"},
        {"do": "corrupt", "at": 400, "kind": "foreign"},
        {"do": "corrupt", "at": 450, "kind": "garbage"},
    ]);
    let mut run = play(&bench, &model, &samples, TIME_SCALE, script)?;
    let expected = expected_lines(
        &model,
        &[
            of(&samples, 0, 350),
            Input::Gap(2),
            of(&samples, 351, 400),
            Input::Gap(2),
            of(&samples, 401, 450),
            Input::Gap(2),
            of(&samples, 451, samples.len() / 2),
            Input::Disconnected,
        ],
    )?;
    compare(&mut run, &expected)
}

#[test]
fn a_lost_link_and_a_sleeping_armband_are_reconnected() -> anyhow::Result<()> {
    let test = "a_lost_link_and_a_sleeping_armband_are_reconnected";
    let Some((bench, model, samples)) = prepare(test, 12) else {
        return Ok(());
    };
    let script = json!([
        {"do": "refuse", "count": 1},
        {"do": "vanish", "at": 400, "for_ms": 300},
        {"do": "sleep", "at": 800, "for_ms": 300},
    ]);
    let mut run = play(&bench, &model, &samples, LINK_TIME_SCALE, script)?;
    let expected = expected_lines(
        &model,
        &[
            of(&samples, 0, 400),
            Input::Disconnected,
            of(&samples, 400, 800),
            Input::Disconnected,
            of(&samples, 800, samples.len() / 2),
            Input::Disconnected,
        ],
    )?;
    compare(&mut run, &expected)?;
    assert_eq!(
        (run.event_count("refused"), run.event_count("connected")),
        (1, 3)
    );
    recovers_with_a_full_window(&run.reports()?, Cause::Disconnected);
    let pins = run.pins();
    // A refused connection is retried after the back-off, not after the timeout.
    let streams = pins.iter().find(|pins| pins.armband).expect("a stream");
    assert!(streams.at_us < CONNECT_US, "{}", run.tails());
    // Between two connections the pins were safe.
    let levels: Vec<bool> = pins.iter().map(|pins| pins.valid).collect();
    let rises = levels.windows(2).filter(|pair| !pair[0] && pair[1]).count();
    assert_eq!(rises, 3, "{}", run.tails());
    Ok(())
}

#[test]
fn notifications_during_discovery_change_no_line() -> anyhow::Result<()> {
    let test = "notifications_during_discovery_change_no_line";
    let Some((bench, model, samples)) = prepare(test, 4) else {
        return Ok(());
    };
    let script = json!([{"do": "chatter", "ms": 5}]);
    let mut run = play(&bench, &model, &samples, TIME_SCALE, script)?;
    let expected = expected_lines(&model, &[Input::Samples(&samples), Input::Disconnected])?;
    compare(&mut run, &expected)?;
    assert!(run.event_count("chatter") > 3, "{}", run.tails());
    Ok(())
}

#[test]
fn an_armband_whose_stream_starts_on_another_lane_loses_nothing() -> anyhow::Result<()> {
    let test = "an_armband_whose_stream_starts_on_another_lane_loses_nothing";
    let Some((bench, model, samples)) = prepare(test, 4) else {
        return Ok(());
    };
    let mut run = bench.start(&Scenario {
        model: &model,
        page: Some(super::bound()),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        fault: None,
        script: json!([]),
        arguments: ["--end", "disconnect", "--first-lane", "2"]
            .map(str::to_owned)
            .to_vec(),
    })?;
    let expected = expected_lines(&model, &[Input::Samples(&samples), Input::Disconnected])?;
    compare(&mut run, &expected)
}

#[test]
fn a_low_battery_is_reported_once_and_changes_no_line() -> anyhow::Result<()> {
    let test = "a_low_battery_is_reported_once_and_changes_no_line";
    let Some((bench, model, samples)) = prepare(test, 4) else {
        return Ok(());
    };
    let script = json!([
        {"do": "battery", "at": 100, "percent": 7},
        {"do": "battery", "at": 200, "percent": 6},
    ]);
    let mut run = play(&bench, &model, &samples, TIME_SCALE, script)?;
    let expected = expected_lines(&model, &[Input::Samples(&samples), Input::Disconnected])?;
    compare(&mut run, &expected)?;
    let comments = run.comments();
    let count = |words: &str| comments.iter().filter(|c| c.contains(words)).count();
    assert_eq!(count("battery 80 %"), 1, "{comments:?}");
    assert_eq!(
        (count("battery low: 7 %"), count("battery low")),
        (1, 1),
        "{comments:?}"
    );
    Ok(())
}
