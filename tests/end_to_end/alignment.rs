//! Alignment of a turned armband: after a press of the button and two openings of the hand the device has turned its
//! electrodes.
//!
//! The lines are compared with those of the shared pipeline, whose alignment begins at the sample at which it began on
//! the device: the time at which the device reads the button depends on the emulator's clock.

use myointent::cli::replay::one_recording;
use myointent_tests::emulator::{Bench, Input, Run, Scenario, bench, expected_lines};
use recordings::{Recording, runs};
use serde_json::json;
use shared::intent::{Intent, Vocabulary};
use shared::model::dimensions::Dimensions;
use shared::model::file::random::random_model;
use shared::model::noise::Noise;
use shared::stream::alignment::{Alignment, Arm, PRECISION_ONE, Template};
use shared::stream::safe_state::Cause;
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::command::{AlignCommand, Command};
use shared::units::{CHANNELS, Sample};

/// Pace of the armband, half the usual one: while the encoder takes the window again, it has a patch with each sample.
const PACE: f64 = 1.5;

/// Mean of an open hand that is the same on both arms, in 1/256 octaves.
const SYMMETRICAL: [i16; CHANNELS] = [400, 200, 0, -200, -300, -200, 0, 200];

/// Amplitudes of an opening that is nearly symmetrical.
const NEARLY_SYMMETRICAL: [i32; CHANNELS] = [118, 68, 40, 23, 17, 23, 40, 68];

/// Returns a model whose template is a ramp round the arm, or about another mean, 2 nats per square octave in every
/// direction.
fn model(mean: Option<[i16; CHANNELS]>) -> Vec<u8> {
    let dimensions = Dimensions {
        width: 48,
        layers: 2,
        span: 27,
        vocabulary: Vocabulary::Three,
        other: false,
    };
    let mut parts = random_model(dimensions, 3);
    if let Some(mean) = mean {
        let mut precision = [0; CHANNELS * (CHANNELS + 1) / 2];
        for diagonal in [0, 8, 15, 21, 26, 30, 33, 35] {
            precision[diagonal] = 2 * PRECISION_ONE;
        }
        parts.template = Template::new(mean, precision).ok();
    }
    parts.to_bytes().expect("a writable model")
}

/// Amplitudes of noise that falls round the arm as the ramp does.
const RAMP: [i32; CHANNELS] = [118, 86, 62, 44, 32, 24, 16, 12];

/// Returns noise of these amplitudes: gestures of a second at 4 s and at 6 s, one of 1.5 s at 9.5 s, rest besides.
fn two_openings(open: [i32; CHANNELS]) -> Vec<Sample> {
    let mut noise = Noise(9);
    (0..2400)
        .map(|index| {
            let is_active = matches!(index, 800..1000 | 1200..1400 | 1900..2200);
            open.map(|most: i32| {
                let most = if is_active { most } else { 4 };
                (noise.signed() * most as f32) as i8
            })
        })
        .collect()
}

/// Returns the samples that an armband in this placement sends.
fn worn(samples: &[Sample], placement: Alignment) -> Vec<Sample> {
    let inverse = placement.inverse();
    samples
        .iter()
        .map(|&sample| inverse.apply(sample))
        .collect()
}

/// Streams; at the first sample presses the button, or sends a command that tells the arm. Compares all lines; returns
/// the reports of the alignment.
fn align(
    bench: &Bench,
    model: &[u8],
    samples: &[Sample],
    arm: Arm,
) -> anyhow::Result<(Run, Vec<AlignmentReport>)> {
    let mut run = bench.start(&Scenario {
        model,
        page: Some(super::bound()),
        samples,
        time_scale: super::TIME_SCALE,
        pace: PACE,
        fault: None,
        script: json!([]),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })?;
    // The alignment needs a stream.
    run.wait_for("the stream", |run| {
        run.pins().last().is_some_and(|pins| pins.armband)
    })?;
    match arm {
        Arm::Unknown => run.set_button(true)?,
        Arm::Known { .. } => {
            let begin = Command::Align(AlignCommand::Begin(arm));
            // The pin says that the armband is followed a moment before the inference has its first packet.
            let mut answer = run.ask(&begin.to_string())?;
            while answer == "ERR,no-stream" {
                answer = run.ask(&begin.to_string())?;
            }
            assert_eq!(answer, "OK,ALIGN,begin");
        }
    }
    run.wait_for("an alignment to begin", |run| {
        run.alignments().is_ok_and(|news| !news.is_empty())
    })?;
    run.set_button(false)?;
    run.wait_for("the end of the stream", |run| {
        let reports = run.reports().unwrap_or_default();
        let last = reports.last().and_then(|report| report.status.cause());
        last == Some(Cause::Disconnected)
    })?;
    run.wait_for("the last line of the alignment", |run| {
        let news = run.alignments().unwrap_or_default();
        news.last()
            .is_some_and(|news| news.state == AlignmentState::Disconnected)
    })?;
    let news = run.alignments()?;
    let begun = news[0].emitted.0 as usize + 1;
    // 700 leaves room: 45 ms of the guest's clock are some 70 samples, and this program looks for the stream every 10
    // ms. Gestures begin at 800.
    assert!(begun.is_multiple_of(2) && begun < 700, "begun at {begun}");
    let (before, after) = samples.split_at(begun);
    let expected = expected_lines(
        model,
        &[
            Input::Samples(before),
            Input::Align(arm),
            Input::Samples(after),
            Input::Disconnected,
        ],
    )?;
    assert_eq!(run.lines(), expected, "{}", run.tails());
    run.check()?;
    Ok((run, news))
}

/// Returns the first two openings of the hand in a recording, with rest before, between and after them, then its first
/// seconds.
fn two_openings_of(recording: &Recording, seconds: usize) -> Vec<Sample> {
    let all = runs(&recording.labels);
    let labelled = |wanted| all.iter().filter(move |run| run.label == Some(wanted));
    let rest = labelled(Intent::Relax).find(|run| run.samples() >= 200);
    let rest = rest.expect("a second of rest").start;
    let rest = &recording.samples[rest..rest + 200];
    let mut stream = rest.to_vec();
    for run in labelled(Intent::Open).take(2) {
        // People move earlier or later than their labels.
        stream.extend(&recording.samples[run.start.saturating_sub(100)..run.end + 100]);
        stream.extend(rest);
    }
    stream.extend(&recording.samples[..seconds * 200]);
    stream.truncate(stream.len() / 2 * 2);
    stream
}

/// Checks that an alignment of the synthetic openings finds this placement.
fn finds(test: &str, placement: Alignment) -> anyhow::Result<()> {
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = worn(&two_openings(RAMP), placement);
    let news = lines_and_led(&bench, &model(None), &samples, Arm::Unknown)?;
    assert_eq!(news[2].alignment, placement);
    Ok(())
}

/// Checks the lines and the LED of an alignment of the synthetic openings; returns its reports.
fn lines_and_led(
    bench: &Bench,
    model: &[u8],
    samples: &[Sample],
    arm: Arm,
) -> anyhow::Result<Vec<AlignmentReport>> {
    let (run, news) = align(bench, model, samples, arm)?;
    let states: Vec<_> = news
        .iter()
        .map(|news| (news.state, news.gestures))
        .collect();
    let expected = [
        (AlignmentState::Waiting, 0),
        (AlignmentState::Waiting, 1),
        (AlignmentState::Aligned, 2),
        (AlignmentState::Disconnected, 0),
    ];
    assert_eq!(states, expected, "{}", run.tails());
    // At most 0.4 s lie between the last label before the change and the first after it.
    let reports = run.reports()?;
    let valid = reports.iter().filter(|report| report.status.valid());
    let after: Vec<_> = valid
        .filter(|report| report.emitted >= news[2].emitted)
        .collect();
    assert!(after.len() > 20, "{} labels after it", after.len());
    assert!(
        after[0].emitted.since(news[2].emitted) <= 80,
        "{}",
        after[0]
    );

    // The LED is dark, then blinks while gestures are waited for, then is lit until the armband has gone.
    let mut led: Vec<_> = run.pins().iter().map(|pins| pins.alignment_led).collect();
    led.dedup();
    assert!(
        led.len() >= 5 && !led[0] && led.len() % 2 == 1,
        "{led:?}\n{}",
        run.tails()
    );
    let valid = run.pins().into_iter().rfind(|pins| pins.valid);
    assert!(
        valid.is_some_and(|pins| pins.alignment_led),
        "{}",
        run.tails()
    );
    Ok(news)
}

#[test]
fn an_opening_that_does_not_tell_the_arm_is_decided_by_the_model_and_the_lines_equal_the_pipelines()
-> anyhow::Result<()> {
    let test = "an_opening_that_does_not_tell_the_arm_is_decided_by_the_model_and_the_lines_equal_the_pipelines";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let samples = worn(&two_openings(NEARLY_SYMMETRICAL), Alignment::new(3, false));
    let news = lines_and_led(&bench, &model(Some(SYMMETRICAL)), &samples, Arm::Unknown)?;
    // The second gesture ends at 1400 and is over 20 samples later; then the encoder takes a patch with each of 106 samples.
    let decided = news[2].emitted.0;
    assert!((1520..1560).contains(&decided), "decided at {decided}");
    Ok(())
}

#[test]
fn the_arm_that_a_command_tells_is_not_left_to_the_model_and_the_lines_equal_the_pipelines()
-> anyhow::Result<()> {
    let test =
        "the_arm_that_a_command_tells_is_not_left_to_the_model_and_the_lines_equal_the_pipelines";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let placement = Alignment::new(3, true);
    let samples = worn(&two_openings(NEARLY_SYMMETRICAL), placement);
    let arm = Arm::Known { mirrored: true };
    let news = lines_and_led(&bench, &model(Some(SYMMETRICAL)), &samples, arm)?;
    assert_eq!(news[2].alignment, placement);
    // The decision comes with the end of the second gesture.
    let decided = news[2].emitted.0;
    assert!((1400..1450).contains(&decided), "decided at {decided}");
    Ok(())
}

#[test]
fn an_armband_turned_by_three_places_is_aligned_and_the_lines_equal_the_pipelines()
-> anyhow::Result<()> {
    let test = "an_armband_turned_by_three_places_is_aligned_and_the_lines_equal_the_pipelines";
    finds(test, Alignment::new(3, false))
}

#[test]
fn an_armband_on_the_other_arm_is_aligned_and_the_lines_equal_the_pipelines() -> anyhow::Result<()>
{
    let test = "an_armband_on_the_other_arm_is_aligned_and_the_lines_equal_the_pipelines";
    finds(test, Alignment::new(6, true))
}

#[test]
fn a_recorded_persons_turned_armband_is_aligned_and_the_lines_equal_the_pipelines()
-> anyhow::Result<()> {
    let test = "a_recorded_persons_turned_armband_is_aligned_and_the_lines_equal_the_pipelines";
    let Some(path) = super::recording(test, "roshambo/data/subject02_session01_emg.npy") else {
        return Ok(());
    };
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let recording = one_recording(&path, None)?;
    let placement = Alignment::new(3, false);
    let samples = worn(&two_openings_of(&recording, 5), placement);
    let (run, news) = align(&bench, &super::model(), &samples, Arm::Unknown)?;
    let aligned: Vec<_> = news
        .iter()
        .filter(|news| news.state == AlignmentState::Aligned)
        .collect();
    assert_eq!(aligned.len(), 1, "{}", run.tails());
    // One place beside it counts as right: people differ by that much.
    let places = aligned[0].alignment.places_from(placement);
    assert!(places.is_some_and(|places| places <= 1), "{}", aligned[0]);
    let open = run
        .reports()?
        .into_iter()
        .any(|report| report.emitted > aligned[0].emitted && report.status.label() == Intent::Open);
    assert!(open, "no open hand after it\n{}", run.tails());
    Ok(())
}
