//! A model that is installed by the line: the radio silent, flash that refuses, power that fails at every operation.

use std::iter::repeat_n;

use anyhow::{Context as _, ensure};
use nrf52::softdevice::Fate;
use nrf52::time::ms;
use shared::installation::{Block, Transfer};
use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::random::random_model;
use shared::uart_line::command::Command;
use virtual_armband::{ArmbandFault, Behaviour};
use xtask::firmware::Image;

use super::air;
use myointent_tests::chip::{Board, MODEL, Setting};
use myointent_tests::{found, model_file};

const PAGE_BLOCKS: u32 = 64;
/// Lives of a board whose power fails at every operation: no installation takes more.
const MOST_LIVES: usize = 250;

/// A model file in blocks.
struct Sender {
    file: Vec<u8>,
}

impl Sender {
    /// A small file: two pages of flash, the second one not full.
    fn small(seed: u64) -> Self {
        let dimensions = Dimensions::new(Vocabulary::Three, 16, 1, 27);
        let file = random_model(dimensions, seed).to_bytes();
        let file = file.expect("a writable model");
        assert_eq!(file.len().div_ceil(4096), 2, "{} bytes", file.len());
        Self { file }
    }

    fn transfer(&self) -> Transfer {
        Transfer::of(&self.file)
    }

    fn block(&self, number: u32) -> Command {
        Command::Block(number, Block::of(&self.file, number))
    }

    fn is_in(&self, board: &Board) -> bool {
        let found = board.memory().read(MODEL, self.file.len() as u32);
        found.as_ref() == Some(&self.file)
    }
}

/// Sends a command and waits for its answer; none if the board starts again instead.
fn ask(board: &mut Board, command: Command) -> anyhow::Result<Option<String>> {
    let (before, starts) = (board.sent_bytes(), board.machine.incidents.len());
    board.send_bytes(command.to_string().bytes());
    let answer = |board: &Board| {
        let new = board.text_from(before);
        let mut lines = new.split_inclusive('\n');
        let is_answer = |line: &&str| line.starts_with("$OK") || line.starts_with("$ERR");
        let line = lines.find(|line| line.ends_with('\n') && is_answer(line));
        line.map(str::to_owned)
    };
    let starts_again = |board: &Board| board.machine.incidents.len() > starts;
    board.until(&format!("answer to {command}"), 3000, ms(5), |board| {
        starts_again(board) || answer(board).is_some()
    })?;
    Ok(answer(board).filter(|_| !starts_again(board)))
}

/// Sends a file, and tells what the board asks for after each block: none once it is installed. Returns false if the board
/// starts again.
fn install(
    board: &mut Board,
    sender: &Sender,
    mut asked: impl FnMut(&mut Board, Option<u32>),
) -> anyhow::Result<bool> {
    let mut command = Command::Install(sender.transfer());
    while let Some(answer) = ask(board, command)? {
        let is_done = answer.contains("done");
        let number = answer.split(['*', ',']).nth(2).unwrap_or_default().parse();
        let number = number.ok();
        ensure!(is_done || number.is_some(), "{answer}");
        asked(board, number);
        match number {
            None => return Ok(true),
            Some(number) => command = sender.block(number),
        }
    }
    Ok(false)
}

fn streaming_board() -> anyhow::Result<Option<Board>> {
    let mut board = found!(air::board(Behaviour::default()), None);
    board.wait_for("# armband FA", 10_000)?;
    board.flash().needs_silence = true;
    Ok(Some(board))
}

#[test]
fn the_radio_is_silent_while_a_model_is_installed() -> anyhow::Result<()> {
    let mut board = found!(streaming_board()?);
    let sender = Sender::small(3);
    let is_done = install(&mut board, &sender, |board, number| {
        let is_loud = board.machine.air().is_in_use();
        let has_begun = number.is_some_and(|number| number > 0);
        assert!(!has_begun || !is_loud, "before block {number:?}");
    });
    assert!(is_done?, "it started again");
    let identity = ask(&mut board, Command::Identify)?.context("a restart")?;
    let checksum = format!("{:08x}", sender.transfer().checksum);
    assert!(identity.contains(&checksum), "{identity}");
    board.run_ms(5000)?;
    let streams = board.text().matches("# armband FA").count();
    assert_eq!(streams, 2, "{}", board.text());
    Ok(())
}

#[test]
fn the_stream_goes_on_after_an_installation_that_flash_refuses() -> anyhow::Result<()> {
    let mut board = found!(streaming_board()?);
    board.flash().fates.extend(repeat_n(Fate::TimeOut, 4));
    let sender = Sender {
        file: model_file("five-class"),
    };
    ask(&mut board, Command::Install(sender.transfer()))?;
    let answer = ask(&mut board, sender.block(0))?.context("a restart")?;
    assert!(answer.starts_with("$ERR,flash"), "{answer}");
    assert!(board.flash().fates.is_empty(), "flash found no time");
    board.run_ms(5000)?;
    let streams = board.text().matches("# armband FA").count();
    assert_eq!(streams, 2, "{}", board.text());
    Ok(())
}

/// Power fails in the middle of the operation of flash with this number, from now on.
fn cut(board: &mut Board, number: usize) {
    if let Some(softdevice) = &mut board.machine.softdevice {
        let cut = Fate::PowerCut { percent: 50 };
        let fates = repeat_n(Fate::Success, number).chain([cut]);
        softdevice.flash.fates = fates.collect();
    } else {
        board.machine.chip().nvmc.power_fails_after = Some(number);
    }
}

/// Checks that a board that has started has the old model, the new one, or none and says so.
fn check_start(board: &mut Board, from: usize, models: [&Sender; 2]) -> anyhow::Result<()> {
    // What the life before has said is before the name.
    let said = |board: &Board| {
        let text = board.text_from(from);
        let said = text.rsplit_once("# myointent ").map(|(_, said)| said);
        said.unwrap_or_default().to_owned()
    };
    let is_said = |board: &mut Board| said(board).contains("$STATE");
    board.until("state", 1000, ms(2), is_said)?;
    let said = said(board);
    let names = |one: &&Sender| said.contains(&format!("model {:08x},", one.transfer().checksum));
    match models.into_iter().find(names) {
        Some(one) => ensure!(one.is_in(board), "another model than it says:\n{said}"),
        None => ensure!(
            said.contains("model refused,") && said.contains("an installation is not complete"),
            "{said}"
        ),
    }
    let is_valid = board.machine.chip().level(board.pins.valid);
    ensure!(is_valid == Some(false), "valid:\n{said}");
    Ok(())
}

/// Installs a file on a board whose power fails at one operation of flash after the other; returns the blocks on which it
/// did. `next` gives the operation after one that was cut, from the first one that a page takes.
fn install_without_power(built: Image, next: impl Fn(usize) -> usize) -> anyhow::Result<Vec<u32>> {
    let (old, new) = (Sender::small(4), Sender::small(3));
    let setting = Setting {
        model: old.file.clone(),
        behaviour: Behaviour::with(vec![ArmbandFault::Absent]),
        ..Setting::default()
    };
    let mut board = found!(Board::of(built, setting), Vec::new());
    board.wait_for("$STATE", 1000)?;
    let (mut cuts, mut number, mut page) = (Vec::new(), 0, 0);
    while cuts.len() < MOST_LIVES {
        let (mut block, from) = (0, board.sent_bytes());
        cut(&mut board, number);
        let is_done = install(&mut board, &new, |board, asked| {
            let first = block == 0;
            block = asked.unwrap_or(block);
            // The first block takes no operation any more. An operation of the next page is its first one.
            if first && block > 0 && block / PAGE_BLOCKS != page {
                (page, number) = (block / PAGE_BLOCKS, 0);
                cut(board, number);
            }
        });
        if is_done? {
            ensure!(new.is_in(&board), "{built}: not installed");
            return Ok(cuts);
        }
        check_start(&mut board, from, [&old, &new])
            .with_context(|| format!("{built}, operation {number} at block {block}"))?;
        cuts.push(block);
        number = next(number);
    }
    anyhow::bail!(
        "{built}: {MOST_LIVES} lives, the last one to block {:?}",
        cuts.last()
    )
}

#[test]
fn power_that_fails_at_every_operation_of_an_installation_leaves_a_model_or_none()
-> anyhow::Result<()> {
    let cuts = install_without_power(Image::Nrf52840S140, |operation| operation + 1)?;
    let is_cut = |block| cuts.contains(&block);
    let blocks = Sender::small(3).transfer().blocks();
    assert!(cuts.is_empty() || (0..blocks).all(is_cut), "{cuts:?}");
    Ok(())
}

#[test]
fn power_that_fails_in_any_word_of_an_installation_in_time_slots_leaves_a_model_or_none()
-> anyhow::Result<()> {
    // A page is erased in nine parts, and a block has sixteen words: another one in each block.
    let next = |operation| operation + if operation < 10 { 1 } else { 17 };
    let cuts = install_without_power(Image::Nrf52840Sdc, next)?;
    assert!(cuts.is_empty() || cuts.len() > 100, "{cuts:?}");
    Ok(())
}
