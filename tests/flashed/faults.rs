//! Safety of the pins when the program does not run as it should: without an instruction of its own.

use nrf52::Incident;
use nrf52::chip::Reset;
use nrf52::time::ms;
use shared::model::noise::Noise;
use shared::units::Sample;
use xtask::firmware::Image;

use myointent_tests::chip::{self, BOOT_LOADER_RAM, Board, Setting};
use myointent_tests::found;

const FAULTED: &str = "# the run before panicked: hard fault at 0x000f0000, ";

/// Noise of rest and effort in turn.
pub fn effort(seconds: usize) -> Vec<Sample> {
    Noise(5).efforts().take(seconds * 200).collect()
}

/// A board whose labels are valid; where the image cannot be built, reports the test as skipped.
fn board_with_valid_labels() -> anyhow::Result<Option<Board>> {
    let setting = Setting::of(chip::model(), effort(60));
    let mut board = found!(Board::of(Image::Nrf52840S140, setting), None);
    board.until_valid()?;
    Ok(Some(board))
}

/// Milliseconds from a time to the fall of `valid`.
fn fell_after_ms(board: &Board, from: u64) -> Option<u64> {
    let chip = board.machine.chip();
    let fell = |(at, pin, level): &&(u64, u32, Option<bool>)| {
        *at >= from && *pin == board.pins.valid && *level == Some(false)
    };
    let fell = chip.changes.iter().find(fell);
    fell.map(|(at, ..)| (at - from) / ms(1))
}

/// Runs until the program is outside of interrupts.
pub fn leave_interrupts(board: &mut Board) -> anyhow::Result<()> {
    while board.machine.core().is_in_handler() {
        board.machine.run(1)?;
    }
    Ok(())
}

/// Lets the core go on with these instructions, in flash that every image leaves free.
pub fn run_code(board: &mut Board, code: &[u16]) {
    const CODE: u32 = 0x5_4f00;
    let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
    let before = board.memory().read(CODE, bytes.len() as u32);
    assert_eq!(before, Some(vec![0xff; bytes.len()]), "the image is there");
    board.memory().program(CODE, &bytes);
    board.machine.core().jump(CODE);
}

#[test]
fn a_clock_that_stops_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    // RTC1, which has all deadlines.
    board.machine.core().disable(17);
    board.run_ms(3000)?;
    let why = board.starts().pop();
    assert_eq!(why, Some(Reset::Watchdog), "{}", board.text());
    Ok(())
}

#[test]
fn the_guard_of_the_stack_ends_a_program_that_grows_into_it() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    leave_interrupts(&mut board)?;
    // push {r0-r7}, and again.
    run_code(&mut board, &[0xb4ff, 0xe7fd]);
    board.wait_for("a stack overflow", 1000)?;
    assert_eq!(board.starts().pop(), Some(Reset::Software));
    Ok(())
}

#[test]
fn a_fault_after_a_reset_by_the_watchdog_is_told_as_what_it_is() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    board.machine.reset(Reset::Watchdog);
    board.wait_for("started by the watchdog", 1000)?;
    leave_interrupts(&mut board)?;
    board.machine.core().jump(0xf_0000);
    board.wait_for("started by software", 1000)?;
    Ok(())
}

#[test]
fn the_words_of_a_panic_outlive_the_boot_loader_of_a_board_with_usb() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    board.machine.boot_loader_ram = Some(BOOT_LOADER_RAM);
    leave_interrupts(&mut board)?;
    board.machine.core().jump(0xf_0000);
    board.wait_for(FAULTED, 1000)
}

#[test]
fn a_fault_restarts_the_board_within_the_time_that_a_probe_needs() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    leave_interrupts(&mut board)?;
    let from = board.machine.now();
    // Erased flash is no instruction. A core that sleeps finds out when it wakes.
    board.machine.core().jump(0xf_0000);
    board.run_ms(1000)?;
    let [
        ..,
        (faulted, Incident::HardFault(_)),
        (at, Incident::Started(why)),
    ] = &board.machine.incidents[..]
    else {
        panic!("{:?}", board.machine.incidents);
    };
    let fell = fell_after_ms(&board, from);
    assert!(fell.is_some_and(|after| after <= 50), "{fell:?} ms");
    assert_eq!(*why, Reset::Software);
    assert!(board.text().contains("software"), "{}", board.text());
    // Nobody reads a debugger's log in the field.
    assert!(board.text().contains(FAULTED), "{}", board.text());
    // A loop's turn takes four cycles here, three on a chip.
    let took = (at - faulted) / ms(1);
    assert!((50..=70).contains(&took), "{took} ms");
    Ok(())
}
