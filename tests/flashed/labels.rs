//! The labels of an image are those of `replay`, byte for byte, from reset on.

use anyhow::Context as _;
use myointent::cli::replay;
use xtask::firmware::Image;

use myointent_tests::chip::{self, Board, Setting};

/// Reads the number of notifications that the board says it has heard.
fn heard(text: &str) -> anyhow::Result<usize> {
    let said = text.split_once("notifications ").map(|(_, rest)| rest);
    let number = said.and_then(|said| said.split_once(','));
    let (number, _) = number.context("no line of a stream that is over")?;
    Ok(number.parse()?)
}

fn labels_equal_replays(
    test: &str,
    built: Image,
    recording: &str,
    seconds: usize,
) -> anyhow::Result<()> {
    let Some(path) = myointent_tests::data(test).map(|folder| folder.join(recording)) else {
        return Ok(());
    };
    if !path.is_file() {
        let missing = format!("no {}: see docs/recordings.md", path.display());
        myointent_tests::skip(test, &missing);
        return Ok(());
    }
    let Some(image) = chip::image(test, built) else {
        return Ok(());
    };
    let mut samples = replay::one_recording(&path, None)?.samples;
    samples.truncate(seconds * 200);
    let setting = Setting {
        samples: samples.clone(),
        ..Setting::default()
    };
    let model = setting.model.clone();
    let mut board = Board::new(built, image, setting);
    // Time to find the armband, and for the last state.
    board.run_ms(seconds as u64 * 1000 + 6000)?;
    let lines = board.lines();
    let text = board.text();
    assert_eq!(heard(&text)?, board.sent(), "notifications:\n{text}");
    let expected = replay::lines(&model, &samples)?;
    let expected: Vec<_> = expected.split_inclusive('\n').collect();
    assert!(
        lines.len() > expected.len(),
        "{} lines:\n{text}",
        lines.len()
    );
    assert_eq!(lines[..expected.len()], expected, "\n{text}");
    assert!(
        lines[expected.len()].contains("disconnected"),
        "{}",
        lines[expected.len()]
    );
    Ok(())
}

#[test]
fn roshambo_on_the_nrf52840_equals_replay() -> anyhow::Result<()> {
    let recording = "roshambo/data/subject02_session01_emg.npy";
    let test = "roshambo_on_the_nrf52840_equals_replay";
    labels_equal_replays(test, Image::Nrf52840S140, recording, 15)
}

#[test]
fn myo_readings_on_the_nrf52840_equals_replay() -> anyhow::Result<()> {
    let recording = "myo-readings/_readings_right_hand/21547-1/7.txt";
    let test = "myo_readings_on_the_nrf52840_equals_replay";
    labels_equal_replays(test, Image::Nrf52840S140, recording, 10)
}

#[test]
fn one_subject_myo_on_the_nrf52840_equals_replay() -> anyhow::Result<()> {
    let recording = "one-subject-myo/stream/raw_emg.csv";
    let test = "one_subject_myo_on_the_nrf52840_equals_replay";
    labels_equal_replays(test, Image::Nrf52840S140, recording, 15)
}

#[test]
fn ss_stm_on_the_nrf52840_equals_replay() -> anyhow::Result<()> {
    let recording = "ss-stm/data/sub1/M8T1.csv";
    let test = "ss_stm_on_the_nrf52840_equals_replay";
    labels_equal_replays(test, Image::Nrf52840S140, recording, 5)
}

#[test]
fn ss_stm_on_the_nrf52840_without_a_softdevice_equals_replay() -> anyhow::Result<()> {
    let recording = "ss-stm/data/sub1/M8T1.csv";
    let test = "ss_stm_on_the_nrf52840_without_a_softdevice_equals_replay";
    labels_equal_replays(test, Image::Nrf52840Sdc, recording, 5)
}

#[test]
fn ss_stm_on_the_nrf52832_equals_replay() -> anyhow::Result<()> {
    let recording = "ss-stm/data/sub1/M8T1.csv";
    let test = "ss_stm_on_the_nrf52832_equals_replay";
    labels_equal_replays(test, Image::Nrf52832S132, recording, 5)
}
