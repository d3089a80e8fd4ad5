//! Start of the program, from reset to the first lines.

use nrf52::Incident;
use nrf52::chip::{APPROTECT, Reset};
use nrf52::softdevice::boot::SOFTDEVICE_VERSION;
use xtask::firmware::Image;

use myointent_tests::chip::{self, Board, Setting};

/// Why the program has started, each time.
fn starts(board: &Board) -> Vec<Reset> {
    let incidents = board.machine.incidents.iter();
    let started = incidents.filter_map(|(_, incident)| match incident {
        Incident::Started(why) => Some(*why),
        Incident::HardFault(_) => None,
    });
    started.collect()
}

#[test]
fn a_board_says_why_it_starts_and_who_it_is() -> anyhow::Result<()> {
    let test = "a_board_says_why_it_starts_and_who_it_is";
    let Some(image) = chip::image(test, Image::Nrf52840S140) else {
        return Ok(());
    };
    let mut board = Board::new(Image::Nrf52840S140, image, Setting::default());
    board.wait_for("power or reset", 1000)?;
    board.send("IDENTIFY");
    board.wait_for("$OK,IDENTIFY", 1000)?;
    assert_eq!(starts(&board), [Reset::Power]);
    Ok(())
}

#[test]
fn the_uart_runs_on_the_crystal() -> anyhow::Result<()> {
    let test = "the_uart_runs_on_the_crystal";
    for built in [Image::Nrf52840S140, Image::Nrf52832S132] {
        let Some(image) = chip::image(test, built) else {
            return Ok(());
        };
        let mut board = Board::new(built, image, Setting::default());
        board.wait_for("$STATE", 1000)?;
        let softdevice = board.machine.softdevice.as_ref();
        assert!(softdevice.is_some_and(|softdevice| softdevice.keeps_crystal));
    }
    Ok(())
}

#[test]
fn the_errata_of_the_nrf52832_are_worked_around() -> anyhow::Result<()> {
    let test = "the_errata_of_the_nrf52832_are_worked_around";
    let Some(image) = chip::image(test, Image::Nrf52832S132) else {
        return Ok(());
    };
    let mut board = Board::new(Image::Nrf52832S132, image, Setting::default());
    // Refused otherwise: sleep without the workaround of 108, a start of the RC oscillator against that of 132.
    for why in [Reset::Pin, Reset::Software, Reset::Watchdog] {
        board.run_ms(1000)?;
        board.machine.reset(why);
    }
    board.run_ms(1000)?;
    Ok(())
}

#[test]
fn an_older_softdevice_is_named_at_each_start() -> anyhow::Result<()> {
    let test = "an_older_softdevice_is_named_at_each_start";
    let Some(image) = chip::image(test, Image::Nrf52840S140) else {
        return Ok(());
    };
    let mut board = Board::new(Image::Nrf52840S140, image, Setting::default());
    let version = 6_001_001_u32.to_le_bytes();
    let chip = board.machine.chip();
    chip.bus.memory.program(SOFTDEVICE_VERSION, &version);
    drop(chip);
    board.wait_for("SoftDevice 6.1.1 is here, expected 7.x", 2000)?;
    Ok(())
}

#[test]
fn the_reset_button_is_no_watchdog() -> anyhow::Result<()> {
    let test = "the_reset_button_is_no_watchdog";
    let Some(image) = chip::image(test, Image::Nrf52840S140) else {
        return Ok(());
    };
    let mut board = Board::new(Image::Nrf52840S140, image, Setting::default());
    board.wait_for("started by power or reset", 1000)?;
    let before = board.text().len();
    board.machine.reset(Reset::Pin);
    board.run_ms(1000)?;
    let text = board.text();
    let after = text.get(before..).unwrap_or(&text);
    assert!(after.contains("started by power or reset"), "{text}");
    Ok(())
}

#[test]
fn a_blank_chip_sets_its_reset_pin_and_starts_again() -> anyhow::Result<()> {
    let test = "a_blank_chip_sets_its_reset_pin_and_starts_again";
    let Some(image) = chip::image(test, Image::Nrf52840S140) else {
        return Ok(());
    };
    let setting = Setting {
        is_blank: true,
        ..Setting::default()
    };
    let mut board = Board::new(Image::Nrf52840S140, image, setting);
    board.wait_for("# myointent ", 1000)?;
    assert_eq!(starts(&board), [Reset::Power, Reset::Software]);
    // The chip was reset to set UICR, not after a panic.
    board.wait_for("started by power or reset", 1000)?;
    let chip = board.machine.chip();
    assert_eq!([chip.uicr(0x200), chip.uicr(0x204)], [18, 18]);
    assert_eq!(chip.uicr(APPROTECT) & 0xff, 0x5a);
    Ok(())
}
