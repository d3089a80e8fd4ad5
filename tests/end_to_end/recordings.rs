//! Device's lines, equal to those that `myointent replay` prints.

use myointent::cli::replay;
use myointent_tests::emulator::{Input, bench, expected_lines};
use serde_json::json;
use shared::stream::safe_state::Cause;

fn emitted_lines_equal_replays(test: &str, recording: &str, seconds: usize) -> anyhow::Result<()> {
    let Some(samples) = super::samples(test, recording, seconds) else {
        return Ok(());
    };
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let model = super::model();
    let expected = replay::lines(&model, &samples)?;
    let expected: Vec<_> = expected.split_inclusive('\n').collect();
    let mut run = super::play(&bench, &model, &samples, super::TIME_SCALE, json!([]))?;
    run.wait_for("the line after those of the recording", |run| {
        run.lines().len() > expected.len()
    })?;
    let lines = run.lines();
    assert_eq!(lines[..expected.len()], expected, "{}", run.tails());
    // The stream has ended, so the state is safe.
    let last = run.reports()?[expected.len()];
    assert_eq!(last.status.cause(), Some(Cause::Disconnected), "{last}");
    run.wait_for("the pins to be safe", |run| {
        run.pins().last().is_some_and(|pins| !pins.valid)
    })?;
    run.check()
}

#[test]
fn the_oracle_of_misbehaviour_agrees_with_replay_where_nothing_happens() -> anyhow::Result<()> {
    let samples: Vec<_> = (0..2000_i32)
        .map(|n| [(n * n % 251 - 125) as i8; 8])
        .collect();
    let model = super::model();
    let lines = expected_lines(&model, &[Input::Samples(&samples)])?;
    assert_eq!(lines.concat(), replay::lines(&model, &samples)?);
    Ok(())
}

#[test]
fn roshambo_on_the_device_equals_replay() -> anyhow::Result<()> {
    let recording = "roshambo/data/subject02_session01_emg.npy";
    emitted_lines_equal_replays("roshambo_on_the_device_equals_replay", recording, 15)
}

#[test]
fn myo_readings_on_the_device_equals_replay() -> anyhow::Result<()> {
    let recording = "myo-readings/_readings_right_hand/21547-1/7.txt";
    emitted_lines_equal_replays("myo_readings_on_the_device_equals_replay", recording, 15)
}

#[test]
fn one_subject_myo_on_the_device_equals_replay() -> anyhow::Result<()> {
    let recording = "one-subject-myo/stream/raw_emg.csv";
    emitted_lines_equal_replays("one_subject_myo_on_the_device_equals_replay", recording, 25)
}

#[test]
fn ss_stm_on_the_device_equals_replay() -> anyhow::Result<()> {
    let recording = "ss-stm/data/sub1/M8T1.csv";
    emitted_lines_equal_replays("ss_stm_on_the_device_equals_replay", recording, 5)
}
