//! Use of the radio: scans, streams, and silence while flash is erased.

use std::iter::repeat_n;

use nrf52::softdevice::Fate;
use nrf52::time::HZ;
use shared::installation::{BLOCK_BYTES, Block, Transfer};
use shared::model::noise::Noise;
use shared::uart_line::command::Command;
use shared::units::Sample;
use virtual_armband::{Behaviour, Step};
use xtask::firmware::Image;

use myointent_tests::chip::{self, Board, Setting};

/// Seconds of EMG: more than any test runs for.
const STREAM: usize = 120;

fn samples() -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..STREAM * 200)
        .map(|_| [(); 8].map(|()| (noise.signed() * 20.0) as i8))
        .collect()
}

fn board(test: &str, behaviour: Behaviour) -> Option<Board> {
    board_of(test, Image::Nrf52840S140, behaviour)
}

fn board_of(test: &str, built: Image, behaviour: Behaviour) -> Option<Board> {
    let image = chip::image(test, built)?;
    let setting = Setting {
        samples: samples(),
        behaviour,
        ..Setting::default()
    };
    Some(Board::new(built, image, setting))
}

/// Percent of the time in which the receiver is on for a scan, from now on.
fn scanned_percent(board: &mut Board, seconds: u64) -> anyhow::Result<u64> {
    let scanned = |board: &Board| board.machine.air().scanned(board.machine.now());
    let before = scanned(board);
    board.run_ms(seconds * 1000)?;
    Ok((scanned(board) - before) * 100 / (seconds * HZ))
}

#[test]
fn a_board_that_sees_nobody_for_a_minute_scans_a_tenth_of_the_time() -> anyhow::Result<()> {
    let test = "a_board_that_sees_nobody_for_a_minute_scans_a_tenth_of_the_time";
    for built in [Image::Nrf52840S140, Image::Nrf52840Sdc] {
        let behaviour = Behaviour {
            steps: vec![Step::Absent],
            ..Behaviour::default()
        };
        let Some(mut board) = board_of(test, built, behaviour) else {
            return Ok(());
        };
        let at_first = scanned_percent(&mut board, 50)?;
        assert!(at_first > 90, "{built}: {at_first} %");
        board.run_ms(25_000)?;
        let later = scanned_percent(&mut board, 50)?;
        assert!((5..=11).contains(&later), "{built}: {later} %");
        // It is switched on, and found all the same.
        board.machine.air_mut().armbands[0].disconnected(0);
        board.wait_for("# armband FA", 20_000)?;
    }
    Ok(())
}

#[test]
fn a_pairing_scans_all_the_time() -> anyhow::Result<()> {
    let test = "a_pairing_scans_all_the_time";
    let behaviour = Behaviour {
        steps: vec![Step::Absent],
        ..Behaviour::default()
    };
    let Some(mut board) = board(test, behaviour) else {
        return Ok(());
    };
    board.run_ms(90_000)?;
    board.send("BIND,begin");
    board.wait_for("$OK,BIND", 1000)?;
    let pairing = scanned_percent(&mut board, 20)?;
    assert!(pairing > 90, "{pairing} %");
    Ok(())
}

/// Sends a command and waits for its answer.
fn ask(board: &mut Board, command: Command) -> anyhow::Result<String> {
    let before = board.text().len();
    board.send_bytes(command.to_string().bytes());
    let end = board.machine.now() + 3 * HZ;
    loop {
        board.run_ms(5)?;
        let text = board.text();
        let new = text.get(before..).unwrap_or_default();
        let mut lines = new
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n'));
        if let Some(line) = lines.find(|line| line.starts_with("$OK") || line.starts_with("$ERR")) {
            return Ok(line.to_owned());
        }
        anyhow::ensure!(board.machine.now() < end, "{command} has no answer:\n{new}");
    }
}

/// A model file in blocks.
struct Sender {
    file: Vec<u8>,
}

impl Sender {
    fn new(name: &str) -> anyhow::Result<Self> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/");
        let file = std::fs::read(format!("{folder}{name}"))?;
        Ok(Self { file })
    }

    fn transfer(&self) -> Transfer {
        let (_, checksum) = self.file.split_at(self.file.len() - 4);
        Transfer {
            length: self.file.len() as u32,
            checksum: u32::from_le_bytes(checksum.try_into().expect("four bytes")),
        }
    }

    fn block(&self, number: u32) -> Command {
        let rest = &self.file[number as usize * BLOCK_BYTES..];
        let mut block = Block::ERASED;
        let length = rest.len().min(BLOCK_BYTES);
        block.0[..length].copy_from_slice(&rest[..length]);
        Command::Block(number, block)
    }
}

fn streaming_board(test: &str) -> anyhow::Result<Option<Board>> {
    let Some(mut board) = board(test, Behaviour::default()) else {
        return Ok(None);
    };
    board.wait_for("# armband FA", 10_000)?;
    let softdevice = board.machine.softdevice.as_mut();
    softdevice.expect("an image with one").flash.needs_silence = true;
    Ok(Some(board))
}

#[test]
fn the_radio_is_silent_while_a_model_is_installed() -> anyhow::Result<()> {
    let test = "the_radio_is_silent_while_a_model_is_installed";
    let Some(mut board) = streaming_board(test)? else {
        return Ok(());
    };
    let sender = Sender::new("five-class.intent")?;
    let mut answer = ask(&mut board, Command::Install(sender.transfer()))?;
    while !answer.contains("done") {
        let number = answer
            .split(['*', ','])
            .nth(2)
            .and_then(|number| number.parse().ok());
        let number: u32 = number.ok_or_else(|| anyhow::anyhow!("{answer}"))?;
        answer = ask(&mut board, sender.block(number))?;
        let is_loud = board.machine.air().is_in_use();
        assert!(!is_loud || answer.contains("done"), "after block {number}");
    }
    let identity = ask(&mut board, Command::Identify)?;
    let checksum = format!("{:08x}", sender.transfer().checksum);
    assert!(identity.contains(&checksum), "{identity}");
    board.run_ms(5000)?;
    let streams = board.text().matches("# armband FA").count();
    assert_eq!(streams, 2, "{}", board.text());
    Ok(())
}

#[test]
fn the_stream_goes_on_after_an_installation_that_flash_refuses() -> anyhow::Result<()> {
    let test = "the_stream_goes_on_after_an_installation_that_flash_refuses";
    let Some(mut board) = streaming_board(test)? else {
        return Ok(());
    };
    let softdevice = board.machine.softdevice.as_mut();
    let flash = &mut softdevice.expect("an image with one").flash;
    flash.fates.extend(repeat_n(Fate::TimeOut, 4));
    let sender = Sender::new("five-class.intent")?;
    ask(&mut board, Command::Install(sender.transfer()))?;
    let answer = ask(&mut board, sender.block(0))?;
    assert!(answer.starts_with("$ERR,flash"), "{answer}");
    let tried = |board: &Board| {
        board
            .machine
            .softdevice
            .as_ref()
            .map(|one| one.flash.fates.len())
    };
    assert_eq!(tried(&board), Some(0), "flash found no time");
    board.run_ms(5000)?;
    let streams = board.text().matches("# armband FA").count();
    assert_eq!(streams, 2, "{}", board.text());
    Ok(())
}

#[test]
fn every_notification_of_a_stream_is_heard() -> anyhow::Result<()> {
    let test = "every_notification_of_a_stream_is_heard";
    for built in [Image::Nrf52840S140, Image::Nrf52840Sdc] {
        let behaviour = Behaviour {
            steps: vec![Step::Sleep {
                at: 300,
                for_ms: 100_000,
            }],
            ..Behaviour::default()
        };
        let Some(mut board) = board_of(test, built, behaviour) else {
            return Ok(());
        };
        board.wait_for("# stream over", 10_000)?;
        board.run_ms(100)?;
        let said = format!("notifications {},", board.sent());
        assert!(board.text().contains(&said), "{said}:\n{}", board.text());
    }
    Ok(())
}

#[test]
fn a_link_that_is_lost_is_found_again() -> anyhow::Result<()> {
    let test = "a_link_that_is_lost_is_found_again";
    for built in [Image::Nrf52840S140, Image::Nrf52840Sdc] {
        // Out of reach for longer than the supervision time-out; ended by the armband; refused at first.
        let steps = vec![
            Step::Refuse { count: 2 },
            Step::Vanish {
                at: 100,
                for_ms: 6000,
            },
            Step::Sleep {
                at: 200,
                for_ms: 500,
            },
        ];
        let behaviour = Behaviour {
            steps,
            ..Behaviour::default()
        };
        let Some(mut board) = board_of(test, built, behaviour) else {
            return Ok(());
        };
        for stream in 1..=3 {
            while board.text().matches("# armband FA").count() < stream {
                let in_time = board.machine.now() < 60 * HZ;
                anyhow::ensure!(in_time, "{built}, stream {stream}:\n{}", board.text());
                board.run_ms(50)?;
            }
        }
        let text = board.text();
        assert_eq!(text.matches("# stream over").count(), 2, "{built}:\n{text}");
    }
    Ok(())
}

#[test]
fn the_parameters_that_an_armband_prefers_are_said_once() -> anyhow::Result<()> {
    let test = "the_parameters_that_an_armband_prefers_are_said_once";
    let behaviour = Behaviour {
        steps: vec![Step::Sleep { at: 100, for_ms: 1 }],
        ..Behaviour::default()
    };
    let Some(mut board) = board(test, behaviour) else {
        return Ok(());
    };
    board.run_ms(10_000)?;
    let text = board.text();
    assert_eq!(text.matches("# armband FA").count(), 2, "{text}");
    let said = "# the armband prefers an interval of 7.50 to 15.00 ms, latency 0, time-out 3000 ms";
    assert_eq!(text.matches(said).count(), 1, "{text}");
    Ok(())
}
