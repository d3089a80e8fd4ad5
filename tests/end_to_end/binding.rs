//! Choice of the armband: the board follows the bound one, and no other beside it.

use std::thread::sleep;
use std::time::Duration;

use myointent_tests::emulator::{Bench, Fault, Run, Scenario, bench};
use serde_json::json;
use shared::myo::Address;
use shared::stream::alignment::Arm;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::units::Sample;

use super::{ARMBAND, bound};

const STRANGER: &str = "FA:00:00:00:00:01";
/// Line that an unbound board writes.
const NOBODY: &str = "# follows no armband: none is bound.";

fn samples(count: i32) -> Vec<Sample> {
    (0..count)
        .map(|n| [(n % 251 * n % 251 - 125) as i8; 8])
        .collect()
}

/// Starts a board with this page, the armband, and a stranger's armband with this signal strength in dBm; the armband
/// has -50.
fn start(
    bench: &Bench,
    page: Option<Vec<u8>>,
    stranger_dbm: i8,
    samples: &[Sample],
    fault: Option<Fault>,
) -> anyhow::Result<Run> {
    let stranger = format!("{STRANGER},{stranger_dbm}");
    bench.start(&Scenario {
        model: &super::model(),
        page,
        samples,
        // Tests wait for what takes seconds of the guest's clock, so it runs in real time.
        time_scale: 1,
        pace: 1.0,
        fault,
        script: json!([]),
        arguments: ["--stranger", &stranger].map(str::to_owned).to_vec(),
    })
}

fn ask(run: &mut Run, command: BindCommand) -> anyhow::Result<String> {
    run.ask(&Command::Bind(command).to_string())
}

/// Waits until the board says that the binding will outlast a restart.
fn wait_until_kept(run: &mut Run, expected: &str) -> anyhow::Result<()> {
    for _ in 0..100 {
        if ask(run, BindCommand::State)? == expected {
            return Ok(());
        }
        sleep(Duration::from_millis(20));
    }
    anyhow::bail!("never {expected}\n{}", run.tails())
}

fn said(run: &Run, words: &str) -> bool {
    run.comments()
        .iter()
        .any(|comment| comment.starts_with(words))
}

#[test]
fn an_unbound_board_follows_nobody_and_can_be_bound_and_made_to_forget() -> anyhow::Result<()> {
    let test = "an_unbound_board_follows_nobody_and_can_be_bound_and_made_to_forget";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let mut run = start(&bench, None, -60, &samples(12_000), None)?;
    run.wait_for("what to do", |run| said(run, NOBODY))?;
    assert_eq!(ask(&mut run, BindCommand::State)?, "OK,BIND,nobody,-,1");
    // Three seconds are far more than a scan takes. The test waits by time, here and below: a board that follows no
    // armband writes nothing to wait for, and the armbands receive nothing from it.
    sleep(Duration::from_secs(3));
    let connected =
        |run: &Run| run.event_count("connected") + run.event_count("stranger-connected");
    assert_eq!(connected(&run), 0, "{}", run.tails());
    let align = Command::Align(AlignCommand::Begin(Arm::Unknown));
    assert_eq!(run.ask(&align.to_string())?, "ERR,no-stream");

    let armband = Address::parse(ARMBAND)?;
    let answer = ask(&mut run, BindCommand::Set(armband))?;
    assert!(
        answer.starts_with(&format!("OK,BIND,bound,{ARMBAND},")),
        "{answer}"
    );
    wait_until_kept(&mut run, &format!("OK,BIND,bound,{ARMBAND},1"))?;
    run.wait_for("the stream", |run| {
        run.pins().last().is_some_and(|pins| pins.armband)
    })?;
    assert_eq!(run.event_count("stranger-connected"), 0, "{}", run.tails());

    let answer = ask(&mut run, BindCommand::Forget)?;
    assert!(answer.starts_with("OK,BIND,nobody,-,"), "{answer}");
    wait_until_kept(&mut run, "OK,BIND,nobody,-,1")?;
    run.wait_for("the end of the stream", |run| {
        run.pins()
            .last()
            .is_some_and(|pins| !pins.armband && !pins.valid)
    })?;
    sleep(Duration::from_secs(3));
    assert_eq!(connected(&run), 1, "{}", run.tails());
    Ok(())
}

#[test]
fn holding_the_button_binds_the_strongest_armband_and_a_restart_keeps_it() -> anyhow::Result<()> {
    let test = "holding_the_button_binds_the_strongest_armband_and_a_restart_keeps_it";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(12_000);
    let mut run = start(&bench, None, -60, &samples, Some(Fault::Panic))?;
    run.wait_for("what to do", |run| said(run, NOBODY))?;
    run.set_button(true)?;
    run.wait_for("a pairing", |run| said(run, "# pairing: in 30 s"))?;
    run.set_button(false)?;
    assert_eq!(ask(&mut run, BindCommand::State)?, "OK,BIND,pairing,-,1");
    assert_eq!(run.event_count("connected"), 0, "{}", run.tails());
    let follows = format!("# follows {ARMBAND}: bound");
    run.wait_for("the end of the pairing", |run| said(run, &follows))?;
    // The LED blinked.
    let mut led: Vec<_> = run.pins().iter().map(|pins| pins.armband).collect();
    led.dedup();
    assert!(led.len() > 20, "{led:?}");
    // The board panics after its third label.
    run.wait_for("a stream after the restart", |run| {
        let comments = run.comments();
        let restart = comments
            .iter()
            .rposition(|c| c.ends_with(", started by software"));
        restart.is_some_and(|place| {
            let after = &comments[place..];
            after.contains(&follows) && after.iter().any(|c| c.starts_with("# armband FA:12"))
        })
    })?;
    assert_eq!(run.event_count("stranger-connected"), 0, "{}", run.tails());
    Ok(())
}

#[test]
fn a_damaged_page_binds_nobody() -> anyhow::Result<()> {
    let test = "a_damaged_page_binds_nobody";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let erased = vec![0xff; 16];
    let half_written: Vec<u8> = bound()[..8].iter().chain(&erased[8..]).copied().collect();
    let mut without_checksum = bound();
    without_checksum[12..].fill(0xff);
    let mut another_address = bound();
    another_address[6] ^= 1;
    for (name, page) in [
        ("erased", erased),
        ("half written", half_written),
        ("without checksum", without_checksum),
        ("another address", another_address),
    ] {
        let mut run = start(&bench, Some(page), -20, &samples(400), None)?;
        run.wait_for(&format!("what to do, with a page {name}"), |run| {
            said(run, NOBODY)
        })?;
        sleep(Duration::from_secs(1));
        let connected = run.event_count("connected") + run.event_count("stranger-connected");
        assert_eq!(connected, 0, "{name}\n{}", run.tails());
    }
    Ok(())
}
