//! Safety of the pins when the program does not run as it should: without an instruction of its own.

use nrf52::Incident;
use nrf52::chip::Reset;
use nrf52::time::{HZ, ms};
use shared::model::noise::Noise;
use shared::units::Sample;
use xtask::firmware::Image;

use myointent_tests::chip::{BOOT_LOADER_RAM, Board, Setting};
use myointent_tests::found;

/// Noise of rest and effort in turn.
pub fn effort(seconds: usize) -> Vec<Sample> {
    let mut noise = Noise(5);
    let sample = |index: usize| {
        let strength = if index / 300 % 2 == 1 { 90.0 } else { 3.0 };
        [(); 8].map(|()| (noise.signed() * strength) as i8)
    };
    (0..seconds * 200).map(sample).collect()
}

/// A board whose labels are valid; where the image cannot be built, reports the test as skipped.
fn board_with_valid_labels() -> anyhow::Result<Option<Board>> {
    let setting = Setting {
        samples: effort(60),
        ..Setting::default()
    };
    let Some(mut board) = Board::of(Image::Nrf52840S140, setting) else {
        return Ok(None);
    };
    while !is_valid(&board) {
        anyhow::ensure!(
            board.machine.now() < 10 * HZ,
            "never valid:\n{}",
            board.text()
        );
        board.run_ms(10)?;
    }
    Ok(Some(board))
}

pub fn is_valid(board: &Board) -> bool {
    board.machine.chip().level(board.pins.valid) == Some(true)
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

fn last_start(board: &Board) -> Option<(u64, Reset)> {
    let mut incidents = board.machine.incidents.iter().rev();
    incidents.find_map(|(at, incident)| match incident {
        Incident::Started(why) => Some((*at, *why)),
        Incident::HardFault(_) => None,
    })
}

#[test]
fn a_clock_that_stops_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    // RTC1, which has all deadlines.
    board.machine.core().disable(17);
    board.run_ms(3000)?;
    let why = last_start(&board).map(|(_, why)| why);
    assert_eq!(why, Some(Reset::Watchdog), "{}", board.text());
    Ok(())
}

#[test]
fn the_guard_of_the_stack_ends_a_program_that_grows_into_it() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    leave_interrupts(&mut board)?;
    // push {r0-r7}, and again.
    run_code(&mut board, &[0xb4ff, 0xe7fd]);
    board.run_ms(1000)?;
    assert!(
        board.text().contains("a stack overflow"),
        "{}",
        board.text()
    );
    assert_eq!(
        last_start(&board).map(|(_, why)| why),
        Some(Reset::Software)
    );
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
    board.run_ms(1000)?;
    let words = "# the run before panicked: hard fault at 0x000f0000, ";
    assert!(board.text().contains(words), "{}", board.text());
    Ok(())
}

#[test]
fn a_fault_restarts_the_board_within_the_time_that_a_probe_needs() -> anyhow::Result<()> {
    let mut board = found!(board_with_valid_labels()?);
    leave_interrupts(&mut board)?;
    let from = board.machine.now();
    // Erased flash is no instruction. A core that sleeps finds out when it wakes.
    board.machine.core().jump(0xf_0000);
    board.run_ms(1000)?;
    let mut incidents = board.machine.incidents.iter();
    let faulted = incidents.find_map(|(at, incident)| match incident {
        Incident::HardFault(_) => Some(*at),
        Incident::Started(_) => None,
    });
    let faulted = faulted.expect("a hard fault");
    let fell = fell_after_ms(&board, from);
    assert!(fell.is_some_and(|after| after <= 50), "{fell:?} ms");
    let (at, why) = last_start(&board).expect("it has started");
    assert_eq!(why, Reset::Software);
    assert!(board.text().contains("software"), "{}", board.text());
    // Nobody reads a debugger's log in the field.
    let words = "# the run before panicked: hard fault at 0x000f0000, ";
    assert!(board.text().contains(words), "{}", board.text());
    // A loop's turn takes four cycles here, three on a chip.
    let took = (at - faulted) / ms(1);
    assert!((50..=70).contains(&took), "{took} ms");
    Ok(())
}
