//! What the armband does wrong shows in the counters, or not at all, and never in a label.
//!
//! The guest's clock is slow, so that only lanes and bytes can tell what happened. The lines are
//! compared with those of the shared pipeline, told what reached the device.

use myointent_tests::emulator::{Bench, Input, Run, Scene, bench, expected_lines};
use serde_json::json;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::units::Sample;

use super::{PACE, TIME_SCALE, play};

const RECORDING: &str = "roshambo/data/subject02_session01_emg.npy";
/// How long the session waits for a connection.
const CONNECT_US: u32 = 5_000_000;
/// Where the guest mostly waits for its own time to pass.
const LINK_TIME_SCALE: u32 = 3;

/// Bench, model and so many seconds of a recording.
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
fn up_to_two_lost_notifications_are_bridged_and_three_give_up_the_window() -> anyhow::Result<()> {
    let test = "up_to_two_lost_notifications_are_bridged_and_three_give_up_the_window";
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

/// After the state became safe for this cause, the next label has 600 new samples behind it.
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
fn what_comes_twice_swapped_too_long_or_late_leaves_no_trace() -> anyhow::Result<()> {
    let test = "what_comes_twice_swapped_too_long_or_late_leaves_no_trace";
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
fn what_is_short_foreign_or_garbage_counts_as_lost() -> anyhow::Result<()> {
    let test = "what_is_short_foreign_or_garbage_counts_as_lost";
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
fn a_lost_link_is_taken_up_again_and_so_is_a_sleeping_armband() -> anyhow::Result<()> {
    let test = "a_lost_link_is_taken_up_again_and_so_is_a_sleeping_armband";
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
    assert_eq!((run.happened("refused"), run.happened("connected")), (1, 3));
    recovers_with_a_full_window(&run.reports()?, Cause::Disconnected);
    let pins = run.pins();
    // What was refused is tried again as soon as the session sees fit, not when it loses patience.
    let follows = pins.iter().find(|pins| pins.armband).expect("a stream");
    assert!(follows.at_us < CONNECT_US, "{}", run.tails());
    // Between two connections the pins were safe.
    let levels: Vec<bool> = pins.iter().map(|pins| pins.valid).collect();
    let rises = levels.windows(2).filter(|pair| !pair[0] && pair[1]).count();
    assert_eq!(rises, 3, "{}", run.tails());
    Ok(())
}

#[test]
fn an_armband_whose_stream_starts_on_another_lane_loses_nothing() -> anyhow::Result<()> {
    let test = "an_armband_whose_stream_starts_on_another_lane_loses_nothing";
    let Some((bench, model, samples)) = prepare(test, 4) else {
        return Ok(());
    };
    let mut run = bench.start(&Scene {
        model: &model,
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
fn a_battery_that_runs_low_is_told_once_and_disturbs_nothing() -> anyhow::Result<()> {
    let test = "a_battery_that_runs_low_is_told_once_and_disturbs_nothing";
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
    let remarks = run.remarks();
    let told = |words: &str| remarks.iter().filter(|r| r.contains(words)).count();
    assert_eq!(told("battery 80 %"), 1, "{remarks:?}");
    assert_eq!(
        (told("battery low: 7 %"), told("battery low")),
        (1, 1),
        "{remarks:?}"
    );
    Ok(())
}
