//! Starts of boards with USB: crystals that start late or never, and the state in which a boot loader leaves the chip.

use nrf52::chip::{REGOUT0, Reset};
use nrf52::time::{HZ, ms};
use xtask::firmware::Image;

use super::usb::{heard, plug, set_port, started};
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;

/// CLOCK's LFCLKSTART.
const LFCLKSTART: u32 = 0x4000_0008;
/// The watchdog's START, CRV and RREN.
const WDT_START: u32 = 0x4001_0000;
const WDT_CRV: u32 = 0x4001_0504;
const WDT_RREN: u32 = 0x4001_0508;
/// Milliseconds in which the boot loader waits for a second reset.
const BOOT_LOADER_MS: u64 = 500;

/// Asserts that relax is high, that the other labels and `valid` are low, and that the watchdog runs.
fn assert_safe(board: &Board, case: &str) {
    let chip = board.machine.chip();
    let [relax, others @ ..] = board.pins.intents;
    assert_eq!(chip.level(relax), Some(true), "{case}");
    for pin in others
        .into_iter()
        .chain([board.pins.valid, board.pins.strength])
    {
        assert_eq!(chip.level(pin), Some(false), "{case}: pin {pin}");
    }
    assert!(chip.bus.watchdog_runs, "{case}: no watchdog");
}

/// Opens the port of a board and looks for the line that says which clock runs.
fn assert_says_its_clock(board: &mut Board, case: &str) -> anyhow::Result<()> {
    let endpoints = plug(board)?;
    set_port(board, 115_200, true)?;
    board.run_ms(100)?;
    let said = heard(board, endpoints);
    assert!(
        said.contains("# slow clock: the chip's oscillator\r\n"),
        "{case}:\n{said}"
    );
    Ok(())
}

#[test]
fn a_board_with_usb_starts_whatever_its_crystal_does() -> anyhow::Result<()> {
    let [at_once, late, later] = [Some(0), Some(HZ), Some(3 * HZ)];
    let cases = [
        (Image::Xiao, &[at_once, late, later, None][..]),
        (Image::Feather, &[None]),
        (Image::NiceNano, &[None]),
    ];
    for (built, crystals) in cases {
        for crystal in crystals {
            let case = format!("{built}, {crystal:?}");
            let mut board = found!(started(built));
            board.machine.chip().bus.slow_crystal = *crystal;
            board.run_ms(10)?;
            assert_safe(&board, &case);
            board.run_ms(500)?;
            assert_says_its_clock(&mut board, &case)?;
            board.wait_for("# armband FA", 4000)?;
            assert_eq!(
                board.starts()[1..],
                [Reset::Power],
                "{case}:\n{}",
                board.text()
            );
        }
    }
    Ok(())
}

/// A chip as a boot loader leaves it after a reset by software, with its clock and a watchdog.
fn left_by_boot_loader(watchdog: Option<(u32, u32)>) -> Option<Board> {
    let mut board = started(Image::Xiao)?;
    board.machine.reset(Reset::Software);
    let mut chip = board.machine.chip();
    if let Some((periods, handles)) = watchdog {
        for (address, value) in [(WDT_CRV, periods), (WDT_RREN, handles), (WDT_START, 1)] {
            chip.write(address, 4, value);
        }
    }
    chip.write(LFCLKSTART, 4, 1);
    chip.bus.halt(ms(BOOT_LOADER_MS));
    drop(chip);
    Some(board)
}

#[test]
fn a_board_starts_as_its_boot_loader_leaves_the_chip() -> anyhow::Result<()> {
    let seconds = 32_768;
    let [power, software] = [Reset::Power, Reset::Software];
    for (watchdog, expected) in [
        (None, &[power, software][..]),
        // Its own, by another program or the run before.
        (Some((2 * seconds, 1)), &[power, software]),
        (Some((2 * seconds, 1 << 7)), &[power, software]),
        (Some((2 * seconds, 0xff)), &[power, software]),
        // Shorter than the boot loader takes: the reset that follows stops it.
        (Some((seconds / 4, 1)), &[power, software, Reset::Watchdog]),
    ] {
        let case = format!("{watchdog:?}");
        let mut board = found!(left_by_boot_loader(watchdog));
        board.run_ms(BOOT_LOADER_MS + 10)?;
        assert_safe(&board, &case);
        board.run_ms(3000)?;
        assert_eq!(board.starts()[1..], *expected, "{case}:\n{}", board.text());
        assert_says_its_clock(&mut board, &case)?;
        board.wait_for("# armband FA", 4000)?;
    }
    Ok(())
}

#[test]
fn a_board_with_its_battery_at_vddh_gets_levels_of_3_volts() -> anyhow::Result<()> {
    let setting = Setting {
        is_blank: true,
        ..Setting::default()
    };
    let mut board = found!(Board::of(Image::NiceNano, setting));
    board.wait_for("$STATE", 1000)?;
    // 3.3 V.
    assert_eq!(board.machine.chip().uicr(REGOUT0) & 7, 5);
    assert_eq!(board.starts()[1..], [Reset::Power, Reset::Software]);
    Ok(())
}
