//! Boards with USB: from their boot loader to lines and commands on the host's serial port.

use anyhow::{Context as _, bail, ensure};
use nrf52::chip::Reset;
use nrf52::time::{ms, us};
use shared::uart_line::answer::{Answer, Charge};
use shared::uart_line::command::Command;
use shared::uart_line::imu::ImuReport;
use shared::uart_line::line::{Line, LineReader};
use xtask::firmware::Image;

use super::faults::effort;
use myointent_tests::chip::{self, Board, Setting};
use myointent_tests::found;

/// POWER.GPREGRET.
const GPREGRET: u32 = 0x4000_051c;

pub fn started(built: Image) -> Option<Board> {
    Board::of(built, Setting::of(chip::model(), effort(60)))
}

/// Makes a control transfer; returns the bytes that the device sent.
pub fn control(board: &mut Board, setup: [u8; 8], data: &[u8]) -> anyhow::Result<Vec<u8>> {
    board.machine.chip().begin_control(setup, data);
    board.until(&format!("end of {setup:x?}"), 100, us(100), |board| {
        board.machine.chip().usb().control.is_over
    })?;
    let done = board.machine.chip().usb().control.clone();
    ensure!(!done.is_stalled, "refused: {setup:x?}");
    Ok(done.data)
}

fn descriptor(board: &mut Board, kind: u8, number: u8, length: u8) -> anyhow::Result<Vec<u8>> {
    control(board, [0x80, 6, number, kind, 0, 0, length, 0], &[])
}

/// Endpoints for lines, for commands and for reports.
#[derive(Clone, Copy, Debug)]
pub struct Endpoints {
    lines: usize,
    commands: usize,
    /// Endpoint of the keyboard, mouse or gamepad, if there is one.
    pub reports: Option<usize>,
    pub interface: u8,
}

/// Plugs the cable and enumerates, as a host does.
pub fn plug(board: &mut Board) -> anyhow::Result<Endpoints> {
    board.machine.chip().plug_usb(true);
    board.until("pull-up", 1000, ms(1), |board| {
        board.machine.chip().usb().is_attached()
    })?;
    board.machine.chip().reset_usb();
    board.run_ms(10)?;
    let device = descriptor(board, 1, 0, 18)?;
    ensure!(device.len() == 18 && device[1] == 1, "{device:x?}");
    control(board, [0, 5, 7, 0, 0, 0, 0, 0], &[])?;
    ensure!(board.machine.chip().usb().address() == 7);
    let product = descriptor(board, 3, device[15], 255)?;
    let product: Vec<u8> = product[2..].iter().copied().step_by(2).collect();
    ensure!(product == b"myointent", "{product:x?}");
    let head = descriptor(board, 2, 0, 9)?;
    let all = descriptor(board, 2, 0, head[2])?;
    ensure!(all.len() == usize::from(head[2]), "{all:x?}");
    let mut rest = &all[..];
    let (mut lines, mut commands, mut reports) = (None, None, None);
    let (mut interface, mut is_hid) = (0, false);
    while let [length, kind, ..] = rest {
        match (*kind, rest[3]) {
            // An interface.
            (4, _) => (interface, is_hid) = (rest[2], rest[5] == 3),
            // An endpoint that is bulk, or that interrupts.
            (5, transfer) => {
                let number = Some(usize::from(rest[2] & 0xf));
                match (transfer, rest[2] & 0x80) {
                    (2, 0) => commands = number,
                    (2, _) => lines = number,
                    _ if is_hid => reports = number,
                    _ => {}
                }
            }
            _ => {}
        }
        rest = &rest[usize::from(*length)..];
    }
    control(board, [0, 9, 1, 0, 0, 0, 0, 0], &[])?;
    let polled = reports.map_or(0, |endpoint| 1 << endpoint);
    board.machine.chip().poll_usb(polled);
    Ok(Endpoints {
        lines: lines.context("no endpoint for lines")?,
        commands: commands.context("no endpoint for commands")?,
        reports,
        interface,
    })
}

/// Opens the port at a baud rate, or closes it.
pub fn set_port(board: &mut Board, baud: u32, is_open: bool) -> anyhow::Result<()> {
    let [a, b, c, d] = baud.to_le_bytes();
    control(
        board,
        [0x21, 0x20, 0, 0, 0, 0, 7, 0],
        &[a, b, c, d, 0, 0, 8],
    )?;
    control(board, [0x21, 0x22, is_open.into(), 0, 0, 0, 0, 0], &[])?;
    board.machine.chip().read_usb(is_open);
    Ok(())
}

/// Bytes of lines that the host has received, in the packets from this one on.
fn received(board: &Board, endpoints: Endpoints, from: usize) -> Vec<u8> {
    let chip = board.machine.chip();
    let packets = chip.usb().taken[from..].iter();
    let packets = packets.filter(|(endpoint, _)| *endpoint == endpoints.lines);
    packets.flat_map(|(_, packet)| packet).copied().collect()
}

/// Text that the host has received.
pub fn heard(board: &Board, endpoints: Endpoints) -> String {
    String::from_utf8_lossy(&received(board, endpoints, 0)).into_owned()
}

/// A started XIAO whose port is open.
fn opened() -> anyhow::Result<Option<(Board, Endpoints)>> {
    let mut board = found!(started(Image::Xiao), None);
    board.run_ms(1000)?;
    let endpoints = plug(&mut board)?;
    set_port(&mut board, 115_200, true)?;
    board.run_ms(100)?;
    Ok(Some((board, endpoints)))
}

#[test]
fn the_host_hears_the_lines_of_the_uart_and_is_answered() -> anyhow::Result<()> {
    let (mut board, endpoints) = found!(opened()?);
    board.run_ms(5000)?;
    // A command in two halves by the UART, and another one between them.
    board.send_bytes("$COUN".bytes());
    board.run_ms(20)?;
    let command = b"$IDENTIFY*04\r\n";
    board.machine.chip().send_usb(endpoints.commands, command);
    board.run_ms(50)?;
    board.send_bytes("TERS*07\r\n".bytes());
    board.wait_for("$OK,COUNTERS", 1000)?;
    board.run_ms(100)?;
    let (uart, usb) = (board.text(), heard(&board, endpoints));
    assert!(usb.starts_with("# myointent "), "{usb}");
    assert!(usb.contains("$LABEL"), "{usb}");
    assert!(
        usb.contains("$OK,IDENTIFY,") && !usb.contains("$ERR"),
        "{usb}"
    );
    // One may be a line ahead.
    let whole = |text: &str| text.rfind('\n').map_or(0, |end| end + 1);
    let end = whole(&uart).min(whole(&usb));
    assert_eq!(uart[..end], usb[..end]);
    Ok(())
}

#[test]
fn movement_comes_by_usb_alone_where_its_host_has_asked_for_it() -> anyhow::Result<()> {
    let (mut board, endpoints) = found!(opened()?);
    board.wait_for("# armband FA", 10_000)?;
    // By the UART it is refused.
    board.ask("IMU,on", "$ERR,no-room")?;
    board.run_ms(1000)?;
    assert!(!heard(&board, endpoints).contains("$IMU"));
    let ask = |board: &mut Board, command: Command| {
        let line = command.to_string();
        board
            .machine
            .chip()
            .send_usb(endpoints.commands, line.as_bytes());
        board.run_ms(2000)
    };
    let asked = board.machine.chip().usb().taken.len();
    ask(&mut board, Command::Imu(true))?;
    ask(&mut board, Command::Raw(true))?;
    ask(&mut board, Command::Imu(false))?;
    let over = board.machine.chip().usb().taken.len();
    board.run_ms(500)?;
    let mut reader = LineReader::default();
    let (mut moved, mut first) = (Vec::new(), None);
    for byte in received(&board, endpoints, asked) {
        match reader.push(byte) {
            Some(Ok(Line::Imu(report))) => moved.push(report),
            Some(Ok(Line::Emg(report))) => first = first.or(Some(report.first)),
            Some(Err(error)) => bail!("{error}"),
            _ => {}
        }
    }
    // 4 s at 50 Hz, one for every four samples.
    assert!((180..=205).contains(&moved.len()), "{}", moved.len());
    for (one, next) in moved.iter().zip(&moved[1..]) {
        let notification = |report: &ImuReport| u32::from(report.imu.0[7].cast_unsigned());
        assert_eq!(one.imu.0[..7], [16_384, 0, 0, 0, 0, 0, 2048]);
        assert_eq!(
            one.sample.0,
            2 * (notification(one) + 1),
            "one clock with the EMG"
        );
        assert_eq!(notification(next), notification(one) + 2);
    }
    let samples = moved[0].sample.0..moved[moved.len() - 1].sample.0;
    assert!(samples.contains(&first.context("no EMG")?.0));
    let after = received(&board, endpoints, over);
    assert!(!String::from_utf8_lossy(&after).contains("$IMU"));
    assert!(!board.text().contains("$IMU"));
    Ok(())
}

#[test]
fn a_host_that_does_not_read_delays_no_label_and_no_watchdog() -> anyhow::Result<()> {
    let (mut board, endpoints) = found!(opened()?);
    board.machine.chip().read_usb(false);
    board.run_ms(6000)?;
    board.ask("COUNTERS", "$OK,COUNTERS")?;
    let text = board.text();
    let labels = text.matches("$LABEL").count();
    assert!(labels > 20, "{labels} labels:\n{text}");
    let counts = text.rsplit("$OK,COUNTERS,").next().unwrap_or_default();
    let dropped = counts.split(['*', ',']).nth(14).unwrap_or_default();
    assert_ne!(dropped, "0", "{counts}");
    assert_eq!(board.starts()[1..], [Reset::Power]);
    // It reads again: new lines come behind the old ones.
    board.machine.chip().read_usb(true);
    board.run_ms(500)?;
    let last = board.lines().pop().context("a line")?;
    assert!(heard(&board, endpoints).contains(last.trim_end()), "{last}");
    Ok(())
}

#[test]
fn a_port_that_is_closed_at_1200_baud_restarts_into_the_boot_loader() -> anyhow::Result<()> {
    let (mut board, _) = found!(opened()?);
    set_port(&mut board, 115_200, false)?;
    board.run_ms(100)?;
    assert_eq!(board.starts()[1..], [Reset::Power]);
    set_port(&mut board, 1200, true)?;
    set_port(&mut board, 1200, false)?;
    board.run_ms(30)?;
    assert_eq!(board.starts()[1..], [Reset::Power, Reset::Software]);
    // What Adafruit's boot loader looks for.
    assert_eq!(board.machine.chip().read(GPREGRET, 4), 0x57);
    Ok(())
}

/// The charge in the newest answer.
fn measured(board: &Board) -> anyhow::Result<Charge> {
    let text = board.text();
    let at = text.rfind("$OK,IDENTIFY,battery,").context("no answer")?;
    let (line, _) = text[at..].split_once('\n').context("no whole line")?;
    match Answer::parse(format!("{line}\n").as_bytes())? {
        Answer::Battery(Some(charge)) => Ok(charge),
        other => bail!("{other}"),
    }
}

/// Asserts equality but for the converter's steps and the divider's whole ohms.
fn assert_near(found: Charge, expected: Charge, built: Image) {
    assert!(
        found.millivolts.abs_diff(expected.millivolts) <= 20
            && found.percent.abs_diff(expected.percent) <= 2,
        "{built}: {found:?}, expected {expected:?}"
    );
}

#[test]
fn the_battery_is_read_and_said_when_it_is_low() -> anyhow::Result<()> {
    // Inputs: AIN7 below 1 MOhm and 510 kOhm, AIN5 below 100 kOhm twice, the chip's divider of its supply by five.
    let low = [
        (Image::Xiao, 8, 3500 * 510 / 1510),
        (Image::Feather, 6, 3500 / 2),
        (Image::NiceNano, 13, 3500 / 5),
    ];
    for (built, input, millivolts) in low {
        let mut board = found!(started(built));
        board.run_ms(500)?;
        assert!(!board.text().contains("battery low"), "{built}");
        board.send("IDENTIFY,battery");
        board.run_ms(50)?;
        let full = Charge {
            millivolts: 4100,
            percent: 95,
        };
        assert_near(measured(&board)?, full, built);
        board.machine.chip().set_input(input, millivolts);
        board.wait_for("# board battery low: ", 11_000)?;
        board.send("IDENTIFY,battery");
        board.run_ms(50)?;
        let found = measured(&board)?;
        let low = Charge {
            millivolts: 3500,
            percent: 6,
        };
        assert_near(found, low, built);
        let said = format!("low: {} %, {} mV", found.percent, found.millivolts);
        assert!(board.text().contains(&said), "{built}: {}", board.text());
    }
    Ok(())
}
