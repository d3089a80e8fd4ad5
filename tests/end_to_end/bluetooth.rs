//! The firmware's Bluetooth host beside another maker's virtual controller and armband: streams, lost links, strangers,
//! damaged packets.

use myointent::cli::replay;
use myointent_tests::bench::{Run, Scenario, python};
use myointent_tests::chip;
use myointent_tests::found;
use serde_json::{Value, json};
use shared::myo::binding;
use shared::stream::safe_state::Cause;
use shared::units::Sample;
use virtual_armband::ADDRESS;

/// Factor by which the board's clock runs slower than the PC's. The timeout of 200 ms is then 0.6 s: an armband that waits for
/// a core does not look silent.
const SLOWED: u32 = 3;

/// Streams these samples, faster than an armband; without what it needs, reports the test as skipped.
fn start(
    samples: &[Sample],
    pace: f64,
    script: Value,
    arguments: &[&str],
) -> anyhow::Result<Option<Run>> {
    let python = found!(python(), None);
    let scenario = Scenario {
        model: &chip::model(),
        page: binding::to_record(ADDRESS).to_vec(),
        samples,
        slowed: SLOWED,
        pace,
        script,
        arguments: arguments.iter().map(|one| (*one).to_owned()).collect(),
    };
    Run::start(python, &scenario).map(Some)
}

fn last_cause(run: &Run) -> Option<Cause> {
    let reports = run.reports().unwrap_or_default();
    reports.last().and_then(|report| report.status.cause())
}

#[test]
fn a_recordings_lines_equal_replays() -> anyhow::Result<()> {
    let path = "roshambo/data/subject02_session01_emg.npy";
    let path = found!(myointent_tests::recorded(path));
    let mut samples = replay::recording_of(&path, None, false)?.samples;
    samples.truncate(15 * 200);
    // Its speech without a subscription means nothing.
    let script = json!([{ "do": "chatter", "ms": 1 }]);
    let mut run = found!(start(&samples, 3.0, script, &["--disconnect"])?);
    let expected = replay::lines(&chip::model(), &samples)?;
    let expected: Vec<_> = expected.split_inclusive('\n').collect();
    run.wait_for("the line after those of the recording", |run| {
        run.lines().len() > expected.len()
    })?;
    assert_eq!(run.lines()[..expected.len()], expected, "{}", run.tails());
    assert_eq!(last_cause(&run), Some(Cause::Disconnected));
    assert!(run.event_count("chatter") >= 4, "{}", run.tails());
    run.check()
}

#[test]
fn a_link_that_is_refused_and_lost_comes_back_and_no_stranger_is_followed() -> anyhow::Result<()> {
    let script = json!([
        { "do": "refuse", "count": 1 },
        { "do": "vanish", "at": 300, "for_ms": 9000 },
        { "do": "sleep", "at": 800, "for_ms": 3000 },
    ]);
    let samples: Vec<_> = (0..3000).map(|n| [(n * n % 251 - 125) as i8; 8]).collect();
    let arguments = ["--disconnect", "--stranger", "F1:23:45:67:89:AB,-20"];
    let mut run = found!(start(&samples, 1.0, script, &arguments)?);
    run.wait_for("three streams", |run| run.event_count("connected") == 3)?;
    run.wait_for("the last one's end", |run| {
        run.event_count("end") > 0 && last_cause(run) == Some(Cause::Disconnected)
    })?;
    assert_eq!(run.event_count("refused"), 1, "{}", run.tails());
    assert_eq!(run.event_count("stranger-connected"), 0, "{}", run.tails());
    run.check()
}

/// Streams with such a packet in place of every 27th notification: each leaves a gap that is bridged.
fn play_with(kind: &str) -> anyhow::Result<Option<Run>> {
    const PACKETS: u32 = 28;
    let script: Vec<_> = (0..PACKETS)
        .map(|number| json!({"do": "corrupt", "at": 400 + 27 * number, "kind": kind}))
        .collect();
    let samples = vec![[1; 8]; 2600];
    let mut run = found!(
        start(&samples, 3.0, script.into(), &["--disconnect"])?,
        None
    );
    run.wait_for("the end", |run| {
        last_cause(run) == Some(Cause::Disconnected)
    })?;
    // The check includes that the board did not restart.
    run.check()?;
    let lost = run.reports()?.last().map(|report| report.counters.lost);
    // A busy host may lose more.
    assert!(lost >= Some(2 * PACKETS), "{lost:?}: {}", run.tails());
    Ok(Some(run))
}

#[test]
fn attribute_pdus_that_end_too_early_do_not_restart_the_board() -> anyhow::Result<()> {
    play_with("cut").map(drop)
}

#[test]
fn the_end_of_a_channel_that_nobody_opened_does_not_restart_the_board() -> anyhow::Result<()> {
    let run = found!(play_with("signal")?);
    // Each is answered, by a command reject: not understood.
    let rejects = run.event_values("signal");
    let is_reject = |value: &String| value.starts_with("01") && value.ends_with("02000000");
    assert!(rejects.iter().all(is_reject), "{rejects:?}");
    assert_eq!(rejects.len(), 28, "{rejects:?}");
    Ok(())
}

#[test]
fn an_armband_that_asks_for_parameters_begins_late_and_hides_subscriptions_streams()
-> anyhow::Result<()> {
    let script = json!([
        { "do": "ask-parameters", "first_ms": 500, "every_ms": 500 },
        { "do": "begin-late", "ms": 6000 },
        { "do": "hide-subscriptions" },
    ]);
    let samples: Vec<_> = (0..2000).map(|n| [(n * n % 251 - 125) as i8; 8]).collect();
    let mut run = found!(start(&samples, 2.0, script, &["--disconnect"])?);
    run.wait_for("the end", |run| {
        last_cause(run) == Some(Cause::Disconnected)
    })?;
    assert_eq!(run.event_count("connected"), 1, "{}", run.tails());
    assert_eq!(run.event_count("unanswered"), 0, "{}", run.tails());
    // Refused, each by its own identifier.
    let answers = run.event_values("signal");
    assert_eq!(answers, ["130102000100", "130202000100", "130302000100"]);
    run.check()
}
