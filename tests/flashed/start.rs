//! Start of the program, from reset to the first lines.

use std::collections::BTreeMap;

use nrf52::chip::{APPROTECT, Reset};
use nrf52::softdevice::boot::SOFTDEVICE_VERSION;
use xtask::firmware::Image;

use super::usb::started;
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;

/// UARTE0.PSEL.TXD and RXD.
const UART_PINS: [u32; 2] = [0x4000_250c, 0x4000_2514];

pub const FLASHED: [Image; 3] = [Image::Nrf52840S140, Image::Nrf52840Sdc, Image::Nrf52832S132];

#[test]
fn the_uart_runs_on_the_crystal() -> anyhow::Result<()> {
    for built in FLASHED {
        let mut board = found!(Board::of(built, Setting::default()));
        board.wait_for("$STATE", 1000)?;
        let softdevice = board.machine.softdevice.as_ref();
        let controller = board.machine.controller.as_ref();
        let keeps = softdevice.map(|one| one.keeps_crystal);
        assert_eq!(
            keeps.or(controller.map(|one| one.keeps_crystal())),
            Some(true)
        );
    }
    Ok(())
}

#[test]
fn a_controller_that_has_too_little_memory_is_named() -> anyhow::Result<()> {
    let mut board = found!(Board::of(Image::Nrf52840Sdc, Setting::default()));
    board.controller().more_bytes = 2000;
    board.wait_for("the Bluetooth controller did not start", 5000)?;
    Ok(())
}

#[test]
fn the_errata_of_the_nrf52832_are_worked_around() -> anyhow::Result<()> {
    let mut board = found!(Board::of(Image::Nrf52832S132, Setting::default()));
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
    let mut board = found!(Board::of(Image::Nrf52840S140, Setting::default()));
    let version = 6_001_001_u32.to_le_bytes();
    let chip = board.machine.chip();
    chip.bus.memory.program(SOFTDEVICE_VERSION, &version);
    drop(chip);
    board.wait_for("SoftDevice 6.1.1 is here, expected 7.x", 2000)?;
    Ok(())
}

#[test]
fn the_reset_button_is_no_watchdog() -> anyhow::Result<()> {
    let mut board = found!(Board::of(Image::Nrf52840S140, Setting::default()));
    board.wait_for("started by power or reset", 1000)?;
    let before = board.sent_bytes();
    board.machine.reset(Reset::Pin);
    board.wait_from(before, "started by power or reset", 1000)
}

#[test]
fn a_blank_chip_sets_its_reset_pin_and_starts_again() -> anyhow::Result<()> {
    for built in FLASHED {
        // Neither a model, nor an armband, nor UICR.
        let setting = Setting {
            model: Vec::new(),
            page: Vec::new(),
            is_blank: true,
            ..Setting::default()
        };
        let mut board = found!(Board::of(built, setting));
        board.wait_for("# model refused", 2000)?;
        assert_eq!(board.starts(), [Reset::Power, Reset::Software], "{built}");
        // The chip was reset to set UICR, not after a panic.
        board.wait_for("started by power or reset", 1000)?;
        let chip = board.machine.chip();
        let reset = board.pins.reset;
        assert_eq!(
            [chip.uicr(0x200), chip.uicr(0x204)],
            [reset, reset],
            "{built}"
        );
        assert_eq!(chip.uicr(APPROTECT) & 0xff, 0x5a, "{built}");
    }
    Ok(())
}

#[test]
fn every_board_starts_on_pins_of_its_own() -> anyhow::Result<()> {
    for built in Image::ALL {
        let mut board = found!(started(built));
        let said = format!("image {built}, model");
        board.wait_for(&said, 1000)?;
        board.wait_for("# armband FA", 10_000)?;
        let pins = board.pins;
        let [relax, others @ ..] = pins.intents;
        let [valid, armband, alignment] = pins.leds;
        let [sends, receives] = pins.uart;
        let high = [relax, pins.button, sends, receives].map(|pin| (pin, true));
        let low = others.into_iter().chain([pins.valid, pins.strength]);
        let leds = [
            (valid, !pins.led_on),
            (armband, pins.led_on),
            (alignment, !pins.led_on),
        ];
        let expected: BTreeMap<u32, bool> = high
            .into_iter()
            .chain(low.chain(pins.low).map(|pin| (pin, false)))
            .chain(leds)
            .collect();
        let chip = board.machine.chip();
        // All others float: the charger's current and state, the supply of VCC, the antenna.
        let levels = (0..48).filter_map(|pin| Some((pin, chip.level(pin)?)));
        assert_eq!(levels.collect::<BTreeMap<_, _>>(), expected, "{built}");
        drop(chip);
        let uart = UART_PINS.map(|register| board.machine.chip().read(register, 4));
        assert_eq!(uart, pins.uart, "{built}");
        // An alignment waits for openings: its LED blinks.
        board.run_ms(100)?;
        board.set_button(true);
        board.run_ms(200)?;
        board.set_button(false);
        board.run_ms(1000)?;
        let lit = (alignment, Some(pins.led_on));
        let is_lit = |(_, pin, level): &(u64, u32, Option<bool>)| (*pin, *level) == lit;
        let blinks = board.machine.chip().changes.iter().any(is_lit);
        assert!(blinks, "{built}:\n{}", board.text());
        board.set_button(true);
        board.wait_for("# pairing", 4000)?;
        let is_power = |why: &Reset| *why == Reset::Power;
        assert!(
            board.starts().iter().all(is_power),
            "{built}:\n{}",
            board.text()
        );
    }
    Ok(())
}
