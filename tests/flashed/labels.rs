//! The labels of the images are those of `replay`, byte for byte, from reset on.

use anyhow::Context as _;
use myointent::cli::replay;

use super::start::FLASHED;
use myointent_tests::chip::{self, Board, Setting};
use myointent_tests::{found, recorded};
use xtask::firmware::Image;
use xtask::stack_chain;

/// Reads the number of notifications that the board says it has heard.
fn heard(text: &str) -> anyhow::Result<usize> {
    let said = text.split_once("notifications ").map(|(_, rest)| rest);
    let number = said.and_then(|said| said.split_once(','));
    let (number, _) = number.context("no line of a stream that is over")?;
    Ok(number.parse()?)
}

/// Bytes of the stack that a program has used: those from the lowest one that no longer holds what it held before.
fn used(before: &[u8], after: &[u8]) -> usize {
    let unused = before
        .iter()
        .zip(after)
        .take_while(|(before, after)| before == after);
    before.len() - unused.count()
}

/// Checks the lines of images for the first seconds of a recording, in which the label changes.
fn labels_equal_replays(name: &str, seconds: usize, images: &[Image]) -> anyhow::Result<()> {
    let path = found!(recorded(name));
    let mut samples = replay::recording_of(&path, None, false)?.samples;
    samples.truncate(seconds * 200);
    let expected = replay::lines(&chip::model(), &samples)?;
    let expected: Vec<_> = expected.split_inclusive('\n').collect();
    let changes = ["relax", "open", "close"].map(|label| expected.concat().contains(label));
    assert!(changes.iter().filter(|one| **one).count() > 1);
    for &built in images {
        let elf = found!(chip::elf(built));
        let setting = Setting::of(chip::model(), samples.clone());
        let mut board = found!(Board::of(built, setting));
        let stack = stack_chain::stack(&elf)?;
        let read = |board: &Board| {
            let bytes = board.memory().read(stack.start, stack.end - stack.start);
            bytes.context("a stack outside RAM")
        };
        let before = read(&board)?;
        // Time to find the armband, and for the last state.
        board.wait_for("# stream over", seconds as u64 * 1000 + 6000)?;
        board.run_ms(200)?;
        let lines = board.lines();
        let text = board.text();
        assert_eq!(heard(&text)?, board.sent(), "{built}:\n{text}");
        let (played, after) = lines.split_at(expected.len().min(lines.len()));
        assert_eq!(played, expected, "{built}:\n{text}");
        let last = after.first().context("no line of the end")?;
        assert!(last.contains("disconnected"), "{built}: {last}");
        // The chain of calls that the images' budget counts with is no shorter than what a run uses.
        let (used, chain) = (used(&before, &read(&board)?), stack_chain::deepest(&elf)?);
        println!(
            "{built}: {used} bytes of stack, the deepest chain has {}",
            chain.bytes
        );
        assert!(used > 2000 && used as u64 <= chain.bytes, "{built}: {used}");
    }
    Ok(())
}

// One set on each image; the others, whose samples are all that differs, on one.
#[test]
fn roshambo_on_each_image_equals_replay() -> anyhow::Result<()> {
    labels_equal_replays("roshambo/data/subject02_session01_emg.npy", 6, &FLASHED)
}

#[test]
fn myo_readings_with_nordics_controller_equals_replay() -> anyhow::Result<()> {
    let recording = "myo-readings/_readings_right_hand/21547-1/7.txt";
    labels_equal_replays(recording, 7, &[Image::Nrf52840Sdc])
}

#[test]
fn one_subject_myo_on_the_nrf52832_equals_replay() -> anyhow::Result<()> {
    let recording = "one-subject-myo/stream/raw_emg.csv";
    labels_equal_replays(recording, 10, &[Image::Nrf52832S132])
}

#[test]
fn ss_stm_with_a_softdevice_equals_replay() -> anyhow::Result<()> {
    labels_equal_replays("ss-stm/data/sub1/M8T1.csv", 5, &[Image::Nrf52840S140])
}
