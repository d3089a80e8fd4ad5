//! Alignment of a turned armband: after a press of the button and two openings of the hand the board has turned its
//! electrodes.
//!
//! The lines are compared with the shared pipeline's, whose alignment begins at the same sample as on the
//! board.

use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::output::BoardOutput;
use nrf52::time::ms;
use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::random::random_model;
use shared::model::noise::Noise;
use shared::stream::alignment::{Alignment, Arm, Template};
use shared::uart_line::alignment::AlignmentState;
use shared::units::{CHANNELS, Sample};
use xtask::firmware::Image;

/// Mean of an open hand that is the same on both arms, in 1/256 octaves.
const SYMMETRICAL: [i16; CHANNELS] = [400, 200, 0, -200, -300, -200, 0, 200];

/// Amplitudes of an opening that is nearly symmetrical.
const NEARLY_SYMMETRICAL: [i32; CHANNELS] = [118, 68, 40, 23, 17, 23, 40, 68];

/// Returns a model whose template is symmetrical, 2 nats per square octave in every direction.
fn model() -> Vec<u8> {
    let dimensions = Dimensions::new(Vocabulary::Three, 48, 2, 27);
    let mut parts = random_model(dimensions, 3);
    parts.template = Template::round(SYMMETRICAL, 2).ok();
    parts.to_bytes().expect("a writable model")
}

/// Returns nearly symmetrical noise: gestures of a second at 4 s and at 6 s, one of 1.5 s at 9.5 s, rest besides.
fn two_openings() -> Vec<Sample> {
    let mut noise = Noise(9);
    (0..2400)
        .map(|index| {
            let is_active = matches!(index, 800..1000 | 1200..1400 | 1900..2200);
            NEARLY_SYMMETRICAL.map(|most: i32| {
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

#[test]
fn an_opening_that_does_not_tell_the_arm_is_decided_by_the_model_and_the_lines_equal_the_pipelines()
-> anyhow::Result<()> {
    let samples = worn(&two_openings(), Alignment::new(3, false));
    let setting = Setting::of(model(), samples.clone());
    let mut board = found!(Board::of(Image::Nrf52840S140, setting));
    board.until("stream", 10_000, ms(10), |board| board.sent() >= 50)?;
    board.set_button(true);
    board.wait_for("$ALIGN,", 1000)?;
    board.set_button(false);
    board.wait_for("# stream over", samples.len() as u64 * 5 + 1000)?;
    board.run_ms(200)?;
    let folder = tempfile::tempdir()?;
    board.write_output(folder.path())?;
    let output = BoardOutput::new(folder.path());
    let news = output.alignments()?;
    let begun = news[0].emitted.0 as usize + 1;
    let (before, after) = samples.split_at(begun);
    let inputs = [
        Input::Samples(before),
        Input::Align(Arm::Unknown),
        Input::Samples(after),
        Input::Disconnected,
    ];
    let expected = expected_lines(&model(), &inputs)?;
    assert_eq!(output.lines(), expected, "{}", output.tails());
    output.check(false)?;
    let (reports, pins) = (output.reports()?, output.pins());
    // The second gesture ends at 1400 and is over 20 samples later; then the encoder takes a patch with each of 106 samples.
    let decided = news[2].emitted.0;
    assert!((1520..1560).contains(&decided), "decided at {decided}");
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
    assert_eq!(states, expected);
    // At most 0.4 s lie between the last label before the change and the first after it.
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
    let mut led: Vec<_> = pins.iter().map(|pins| pins.alignment_led).collect();
    led.dedup();
    assert!(led.len() >= 5 && !led[0] && led.len() % 2 == 1, "{led:?}");
    let valid = pins.into_iter().rfind(|pins| pins.valid);
    assert!(valid.is_some_and(|pins| pins.alignment_led));
    Ok(())
}
