//! Commands on the UART: each is answered, and none changes a label that it was not meant to change.

use myointent_tests::emulator::{Bench, Input, Run, Scenario, bench, board, expected_lines};
use serde_json::json;
use shared::model::noise::Noise;
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentState;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::units::Sample;

use super::{ARMBAND, TIME_SCALE, bound, model};

/// Pace of the armband, half the usual one: while the encoder takes the window again, it has a patch with each sample.
const PACE: f64 = 1.5;

fn samples(count: usize) -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..count)
        .map(|index| {
            let most = if index / 300 % 2 == 0 { 3.0 } else { 90.0 };
            [(); 8].map(|()| (noise.signed() * most) as i8)
        })
        .collect()
}

fn start(bench: &Bench, samples: &[Sample]) -> anyhow::Result<Run> {
    start_at(bench, samples, PACE)
}

fn start_at(bench: &Bench, samples: &[Sample], pace: f64) -> anyhow::Result<Run> {
    let mut run = bench.start(&Scenario {
        model: &model(),
        page: Some(bound()),
        samples,
        time_scale: TIME_SCALE,
        pace,
        fault: None,
        script: json!([]),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })?;
    run.wait_for("the stream", |run| {
        run.pins().last().is_some_and(|pins| pins.armband)
    })?;
    Ok(run)
}

/// Waits for as many lines as expected, and compares them.
fn compare(run: &mut Run, inputs: &[Input<'_>]) -> anyhow::Result<()> {
    let expected = expected_lines(&model(), inputs)?;
    run.wait_for("all lines", |run| run.lines().len() >= expected.len())?;
    assert_eq!(run.lines(), expected, "{}", run.tails());
    run.check()
}

/// Returns a line with the right checksum.
fn framed(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

#[test]
fn each_command_is_answered_and_wrong_lines_are_refused() -> anyhow::Result<()> {
    let test = "each_command_is_answered_and_wrong_lines_are_refused";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(3000);
    let mut run = start(&bench, &samples)?;

    let identity = run.ask(&Command::Identify.to_string())?;
    let fields: Vec<&str> = identity.split(',').collect();
    let file = model();
    let checksum = u32::from_le_bytes(*file.last_chunk().expect("a checksum"));
    assert_eq!(fields[..3], ["OK", "IDENTIFY", env!("CARGO_PKG_VERSION")]);
    let model_name = format!("{checksum:08x}");
    let expected = ["emulator", &model_name, ARMBAND, "1.5.1970", "80"];
    assert_eq!(fields[4..], expected, "{identity}");

    let counters = run.ask(&Command::Counters.to_string())?;
    let numbers: Vec<&str> = counters.split(',').skip(2).collect();
    assert_eq!((numbers.len(), numbers[0]), (16, "1"), "{counters}");
    assert!(numbers[6].parse::<u32>()? > 0, "{counters}");

    let state = run.ask(&Command::Bind(BindCommand::State).to_string())?;
    assert_eq!(state, format!("OK,BIND,bound,{ARMBAND},1"));
    for (line, answer) in [
        ("$IDENTIFY*00\r\n", "ERR,checksum,04"),
        ("$IDENTIFY\r\n", "ERR,frame"),
        (&framed("REBOOT"), "ERR,unknown"),
        (&framed("ALIGN,set,9,0"), "ERR,arguments"),
        (&format!("${}", "x".repeat(120)), "ERR,too-long"),
        (&framed("RAW,off"), "OK,RAW,off"),
        (&framed("ALIGN,begin"), "OK,ALIGN,begin"),
        (&framed("ALIGN,cancel"), "OK,ALIGN,cancel"),
    ] {
        assert_eq!(run.ask(line)?, answer, "{line}");
    }
    run.wait_for("the alignment's end", |run| {
        run.alignments().is_ok_and(|news| news.len() == 2)
    })?;
    let states: Vec<_> = run.alignments()?.iter().map(|news| news.state).collect();
    assert_eq!(states, [AlignmentState::Waiting, AlignmentState::Cancelled]);
    run.check()
}

#[test]
fn without_a_model_a_command_is_refused_with_the_reason() -> anyhow::Result<()> {
    let test = "without_a_model_a_command_is_refused_with_the_reason";
    let Some(board) = board(test) else {
        return Ok(());
    };
    let align = Command::Align(AlignCommand::Begin(Arm::Unknown)).to_string();
    let mut run = board.start_without_armband(&[0xff; 100])?;
    run.wait_for("the start", |run| !run.comments().is_empty())?;
    assert!(
        run.ask(&Command::Identify.to_string())?
            .ends_with(",refused,-,-,-")
    );
    assert_eq!(run.ask(&align)?, "ERR,no-model");
    let state = Command::Bind(BindCommand::State).to_string();
    assert_eq!(run.ask(&state)?, "ERR,no-model");
    Ok(())
}

#[test]
fn a_flood_of_bytes_changes_no_label() -> anyhow::Result<()> {
    let test = "a_flood_of_bytes_changes_no_label";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(3000);
    let mut run = start(&bench, &samples)?;
    let mut noise = Noise(77);
    let asked = 20;
    for _ in 0..asked {
        let bytes: Vec<u8> = (0..3000)
            .map(|_| (noise.signed() * 127.0) as i8 as u8)
            .collect();
        run.send(bytes)?;
        // Bytes before a whole line do not matter.
        run.send(Command::Identify.to_string())?;
    }
    let identified = |run: &Run| {
        let answers = run.answers();
        answers
            .iter()
            .filter(|a| a.starts_with("OK,IDENTIFY"))
            .count()
    };
    run.wait_for("the answers", |run| identified(run) == asked)?;
    let ended = run.event_count("end");
    compare(&mut run, &[Input::Samples(&samples), Input::Disconnected])?;
    assert_eq!(
        ended,
        0,
        "the stream ended before the flood\n{}",
        run.tails()
    );
    Ok(())
}

#[test]
fn an_alignment_set_by_a_command_gives_the_pipelines_lines() -> anyhow::Result<()> {
    let test = "an_alignment_set_by_a_command_gives_the_pipelines_lines";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(2400);
    let mut run = start(&bench, &samples)?;
    run.wait_for("a label", |run| {
        run.reports()
            .is_ok_and(|reports| reports.iter().any(|report| report.status.valid()))
    })?;
    let alignment = Alignment::new(3, true);
    let set = Command::Align(AlignCommand::Set(alignment));
    assert_eq!(run.ask(&set.to_string())?, "OK,ALIGN,set");
    run.wait_for("the alignment", |run| {
        run.alignments().is_ok_and(|news| !news.is_empty())
    })?;
    let news = run.alignments()?[0];
    assert_eq!(
        (news.state, news.alignment),
        (AlignmentState::Set, alignment)
    );
    let (before, after) = samples.split_at(news.emitted.0 as usize + 1);
    assert!(after.len() > 400, "{}", run.tails());
    compare(
        &mut run,
        &[
            Input::Samples(before),
            Input::SetAlignment(alignment),
            Input::Samples(after),
            Input::Disconnected,
        ],
    )
}

#[test]
fn the_raw_stream_equals_the_samples_sent_and_changes_no_label() -> anyhow::Result<()> {
    let test = "the_raw_stream_equals_the_samples_sent_and_changes_no_label";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(1400);
    // The guest gets twice the rate of an armband, and drops what it has no time for.
    let mut run = start_at(&bench, &samples, 2.0 / f64::from(TIME_SCALE))?;
    assert_eq!(run.ask(&Command::Raw(true).to_string())?, "OK,RAW,on");
    run.wait_for("samples", |run| run.emg().is_ok_and(|emg| emg.len() > 400))?;
    assert_eq!(run.ask(&Command::Raw(false).to_string())?, "OK,RAW,off");
    compare(&mut run, &[Input::Samples(&samples), Input::Disconnected])?;
    let emg = run.emg()?;
    let first = emg[0].first.0 as usize;
    assert!(
        first < 600 && emg.len() < 700,
        "{} from {first} on",
        emg.len()
    );
    for (report, place) in emg.iter().zip((first..).step_by(2)) {
        assert_eq!(report.first.0 as usize, place, "{}", run.tails());
        assert_eq!(report.samples, samples[place..place + 2], "{report}");
    }
    let counters = run.ask(&Command::Counters.to_string())?;
    assert!(counters.ends_with(",0,0,0"), "{counters}");
    Ok(())
}

#[test]
fn a_reader_that_stops_reading_changes_no_label() -> anyhow::Result<()> {
    let test = "a_reader_that_stops_reading_changes_no_label";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = samples(4800);
    let (mut run, reader) = bench.start_with_reader(&Scenario {
        model: &model(),
        page: Some(bound()),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        fault: None,
        script: json!([]),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })?;
    run.wait_for("the stream", |run| {
        run.pins().last().is_some_and(|pins| pins.armband)
    })?;
    assert_eq!(run.ask(&Command::Raw(true).to_string())?, "OK,RAW,on");
    reader.pause(true);
    // The pipe is full after 1200 notifications; then the board cannot write, for less time than its watchdog allows.
    run.wait_for("most of the stream", |run| run.event_count("sent") > 1600)?;
    reader.pause(false);
    run.wait_for("the end of the stream", |run| {
        run.pins().last().is_some_and(|pins| !pins.armband)
    })?;
    run.wait_for("the last line", |run| {
        let reports = run.reports().unwrap_or_default();
        reports.last().and_then(|report| report.status.cause()) == Some(Cause::Disconnected)
    })?;
    let expected = expected_lines(&model(), &[Input::Samples(&samples), Input::Disconnected])?;

    // Every line that came is one of those expected, in their order, and the missing ones were counted.
    let lines = run.lines();
    let mut wanted = expected.iter();
    for line in &lines {
        assert!(wanted.any(|wanted| wanted == line), "{line}{}", run.tails());
    }
    let counters = run.ask(&Command::Counters.to_string())?;
    let counts: Vec<usize> = counters.split(',').skip(2).flat_map(str::parse).collect();
    let [.., packets, dropped, emg] = counts[..] else {
        panic!("{counters}");
    };
    assert_eq!(packets, 0, "{counters}");
    assert_eq!(lines.len() + dropped, expected.len(), "{counters}");
    assert!(dropped > 0 && emg > 0, "never full: {counters}");
    let starts = run.lines_by_start()?.len();
    assert_eq!(starts, 1, "restarted\n{}", run.tails());

    // The pins showed every label.
    let reports = expected.iter().map(|line| Report::parse(line.as_bytes()));
    let mut labels = reports
        .map(|report| Ok(report?.status.label()))
        .collect::<anyhow::Result<Vec<_>>>()?;
    labels.dedup();
    let mut shown: Vec<_> = run.pins().iter().map(|pins| pins.high.clone()).collect();
    shown.dedup();
    let labels: Vec<_> = labels.into_iter().map(|label| vec![label]).collect();
    assert_eq!(shown, labels, "{}", run.tails());
    Ok(())
}
