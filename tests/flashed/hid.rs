//! Boards with USB as a keyboard, mouse or gamepad of the computer.

use anyhow::{Context as _, ensure};
use nrf52::Incident;
use nrf52::chip::Reset;
use nrf52::time::ms;
use shared::hid::{DESCRIPTOR_BYTES, descriptor};
use shared::intent::Intent;
use xtask::firmware::Image;

use super::dead_man::model_of;
use super::faults::{effort, leave_interrupts, run_code};
use super::usb::{Endpoints, control, plug};
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;

/// Milliseconds after a hang within which the computer has the release, as docs/board.md says.
const RELEASED_MS: u64 = 250;
/// Milliseconds after a hang within which the board leaves the bus.
const DETACHED_MS: u64 = 2100;
const PRESSED: &[u8] = &[1, 0, 0x2c];
const RELEASED: &[u8] = &[1, 0, 0];

/// A board that labels everything as close, for so many seconds of samples.
fn closing(built: Image, seconds: usize) -> anyhow::Result<Option<Board>> {
    let setting = Setting::of(model_of(Intent::Close)?, effort(seconds));
    Ok(Board::of(built, setting))
}

/// Gives close the space bar, and switches it on.
fn use_space(board: &mut Board) -> anyhow::Result<()> {
    board.run_ms(500)?;
    board.ask("HID,set,close,key:space", "$OK,HID,off,-,key:space,-,-,-*")?;
    board.ask("HID,on", "$OK,HID,on,-,key:space,-,-,-*")?;
    // It leaves the bus, as it is another device.
    Ok(board.run_ms(100)?)
}

/// Reports that the host has taken, from the given packet on.
fn reports(board: &Board, endpoints: Endpoints, from: usize) -> Vec<Vec<u8>> {
    let chip = board.machine.chip();
    let packets = chip.usb().taken[from..].iter();
    packets
        .filter(|(endpoint, _)| Some(*endpoint) == endpoints.reports)
        .map(|(_, report)| report.clone())
        .collect()
}

/// Number of packets that the host has taken.
fn taken(board: &Board) -> usize {
    board.machine.chip().usb().taken.len()
}

/// Runs until the host has this report as its newest.
fn wait_for_report(
    board: &mut Board,
    endpoints: Endpoints,
    report: &[u8],
    at_most_ms: u64,
) -> anyhow::Result<()> {
    board.until(&format!("{report:x?}"), at_most_ms, ms(1), |board| {
        reports(board, endpoints, 0).last().map(Vec::as_slice) == Some(report)
    })
}

/// A board with a plugged cable whose computer has the space bar pressed.
fn pressing(built: Image, seconds: usize) -> anyhow::Result<Option<(Board, Endpoints)>> {
    let mut board = found!(closing(built, seconds)?, None);
    use_space(&mut board)?;
    let endpoints = plug(&mut board)?;
    wait_for_report(&mut board, endpoints, PRESSED, 10_000)?;
    // With the label, and once.
    ensure!(board.is_valid() && reports(&board, endpoints, 0) == [PRESSED]);
    Ok(Some((board, endpoints)))
}

#[test]
fn the_computer_sees_no_keyboard_until_it_is_switched_on() -> anyhow::Result<()> {
    let mut board = found!(closing(Image::Xiao, 60)?);
    board.run_ms(500)?;
    board.ask("HID,set,close,axis:x-", "$OK,HID,off,-,axis:x-,-,-,-*")?;
    ensure!(plug(&mut board)?.reports.is_none());
    // Another device, so it is another one for the host.
    board.ask("HID,on", "$OK,HID,on,-,axis:x-,-,-,-*")?;
    board.run_ms(100)?;
    ensure!(!board.machine.chip().usb().is_attached());
    let endpoints = plug(&mut board)?;
    let described = |board: &mut Board, devices| -> anyhow::Result<()> {
        let mut bytes = [0; DESCRIPTOR_BYTES];
        let expected = descriptor(devices, &mut bytes);
        let [length, interface] = [expected.len() as u8, endpoints.interface];
        let found = control(board, [0x81, 6, 0, 0x22, interface, 0, length + 1, 0], &[])?;
        ensure!(found == expected, "{found:x?}");
        Ok(())
    };
    described(&mut board, [false, false, true])?;
    // As hosts do.
    control(
        &mut board,
        [0x21, 0x0a, 0, 0, endpoints.interface, 0, 0, 0],
        &[],
    )?;
    wait_for_report(
        &mut board,
        endpoints,
        &[3, 0, 0, 0x81, 0, 0, 0, 0, 0],
        20_000,
    )?;
    let strengths = reports(&board, endpoints, 0);
    ensure!(strengths.len() > 5, "{strengths:x?}");
    // It is as before after a loss of power, and gone once it is switched off.
    board.machine.reset(Reset::Power);
    board.machine.chip().plug_usb(false);
    board.run_ms(500)?;
    ensure!(plug(&mut board)?.reports.is_some());
    board.ask("HID,off", "$OK,HID,off,-,axis:x-,-,-,-*")?;
    board.run_ms(100)?;
    ensure!(plug(&mut board)?.reports.is_none());
    Ok(())
}

#[test]
fn a_label_presses_its_key_until_the_state_is_safe() -> anyhow::Result<()> {
    for built in Image::UF2 {
        let (mut board, endpoints) = found!(pressing(built, 12)?);
        for _ in 0..3 {
            board.ask("LOCK,set,100,200", "$OK,LOCK")?;
            wait_for_report(&mut board, endpoints, RELEASED, 200)?;
            board.send("LOCK,off");
            wait_for_report(&mut board, endpoints, PRESSED, 500)?;
        }
        // Another key in place of the one that is down, and none.
        board.send("HID,set,close,key:a");
        wait_for_report(&mut board, endpoints, &[1, 0, 4], 1000)?;
        let all = reports(&board, endpoints, 0);
        assert!(
            all.ends_with(&[RELEASED.to_vec(), vec![1, 0, 4]]),
            "{all:x?}"
        );
        // The armband disconnects after its last sample.
        wait_for_report(&mut board, endpoints, RELEASED, 12_000)?;
        assert!(!board.is_valid());
        assert_eq!(board.starts()[1..], [Reset::Power], "{}", board.text());
    }
    Ok(())
}

#[test]
fn a_bus_that_is_suspended_in_a_press_begins_with_the_release() -> anyhow::Result<()> {
    let (mut board, endpoints) = found!(pressing(Image::Xiao, 60)?);
    let before = taken(&board);
    board.machine.chip().suspend_usb(true);
    board.run_ms(1000)?;
    assert_eq!(taken(&board), before);
    board.machine.chip().suspend_usb(false);
    board.run_ms(20)?;
    // It is still meant.
    assert_eq!(reports(&board, endpoints, before), [RELEASED, PRESSED]);
    // The state becomes safe while the bus sleeps.
    board.machine.chip().suspend_usb(true);
    board.run_ms(100)?;
    board.ask("LOCK,set,100,200", "$OK,LOCK")?;
    board.run_ms(200)?;
    let before = taken(&board);
    board.machine.chip().suspend_usb(false);
    board.run_ms(20)?;
    assert_eq!(reports(&board, endpoints, before), [RELEASED]);
    assert_eq!(board.starts()[1..], [Reset::Power], "{}", board.text());
    Ok(())
}

#[test]
fn a_cable_that_is_pulled_in_a_press_leaves_nothing_pressed() -> anyhow::Result<()> {
    let (mut board, _) = found!(pressing(Image::Xiao, 60)?);
    board.machine.chip().plug_usb(false);
    board.run_ms(10)?;
    assert!(!board.machine.chip().usb().is_attached());
    // Nothing is sent to a host that is not there, by the dead-man timer neither.
    board.machine.chip().bus.halt(ms(400));
    board.run_ms(1000)?;
    let before = taken(&board);
    let endpoints = plug(&mut board)?;
    board.run_ms(6000)?;
    assert_eq!(reports(&board, endpoints, before), [RELEASED, PRESSED]);
    assert_eq!(board.starts()[1..], [Reset::Power], "{}", board.text());
    Ok(())
}

#[test]
fn a_core_that_hangs_in_a_press_releases_the_key_and_then_leaves_the_bus() -> anyhow::Result<()> {
    for (built, halts) in Image::UF2
        .map(|built| (built, true))
        .into_iter()
        .chain([(Image::Xiao, false)])
    {
        let (mut board, endpoints) = found!(pressing(built, 12)?);
        let before = taken(&board);
        if !halts {
            leave_interrupts(&mut board)?;
            // b to itself.
            run_code(&mut board, &[0xe7fe]);
        }
        let hung = board.machine.now();
        let pass = |board: &mut Board, time| match halts {
            // All of the time at once.
            true => {
                board.machine.chip().bus.halt(ms(time));
                board.machine.run(1)
            }
            false => board.run_ms(time),
        };
        pass(&mut board, RELEASED_MS)?;
        assert_eq!(reports(&board, endpoints, before), [RELEASED], "{built}");
        assert!(board.machine.chip().usb().is_attached());
        while board.machine.chip().usb().is_attached() {
            ensure!(
                board.machine.now() < hung + ms(DETACHED_MS),
                "{built}: on the bus"
            );
            pass(&mut board, 10)?;
        }
        let incident = board.machine.incidents.last().context("a reset")?;
        assert!(matches!(incident.1, Incident::Started(Reset::Watchdog)));
    }
    Ok(())
}

#[test]
fn a_core_that_is_late_presses_the_key_again_when_the_label_is_valid_again() -> anyhow::Result<()> {
    let (mut board, endpoints) = found!(pressing(Image::Xiao, 60)?);
    // Any phase to the frames of the bus, and an expiry that the core sees at once.
    for halt in [ms(210), ms(220), ms(226), ms(400)] {
        let before = taken(&board);
        board.machine.chip().bus.halt(halt);
        board.run_ms(1000)?;
        let all = reports(&board, endpoints, before);
        if !board.is_valid() {
            assert_eq!(all.last().map(Vec::as_slice), Some(RELEASED), "{all:x?}");
            assert!(all.iter().all(|report| report == RELEASED), "{all:x?}");
        }
        wait_for_report(&mut board, endpoints, PRESSED, 10_000)?;
    }
    assert_eq!(board.starts()[1..], [Reset::Power], "{}", board.text());
    Ok(())
}
