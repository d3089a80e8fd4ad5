//! Installation of a model on a board on a pseudo-terminal; at random moments the line is cut, or the PC's program
//! killed.

use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::Parser as _;
use myointent::board::{BoardError, InstallError, ModelFile, install};
use myointent::cli::Cli;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::installation::{BLOCK_BYTES, InstallationProgress};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;
use super::installing_board::{Board, flash_of};
use super::scripted::{Scripted, identity};
use super::shipped;

/// Bytes of a block's line and of its answer, approximately.
const BLOCK_LINES: usize = 125;

fn five_class_path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent")
}

fn five_class() -> Vec<u8> {
    std::fs::read(five_class_path()).unwrap()
}

#[test]
fn a_model_is_installed_though_power_and_line_are_cut_at_100_random_moments() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let file = ModelFile::new(&new).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(17);
    // A page has 64 blocks and is written again from its start: about one life in twenty is long enough for a page.
    let page = 64 * BLOCK_LINES;
    let lives = (0..100).map(|_| random.random_range(0..page * 17 / 16));
    let (board, flash) = Board::on(&link, flash_of(&shipped()), lives.collect());
    let mut seen = 0;
    // Where the command has given up it is given again, as a person would.
    let installed =
        (0..200).any(|_| install(&link, file, || false, |blocks| seen = seen.max(blocks)).is_ok());
    assert!(installed);
    assert_eq!(board.off(), 100);
    assert_eq!(seen, file.blocks());
    assert!(flash.lock().unwrap().region.starts_with(&new));
}

/// Environment variable with the port, set for the child process alone: somebody may run all ignored tests.
const PORT: &str = "MYOINTENT_TEST_INSTALL";

/// Starts `myointent board --port LINK install FILE` as a process of its own.
fn start(link: &Path) -> Child {
    Process::new(std::env::current_exe().unwrap())
        .args(["--exact", "install::command", "--ignored", "--nocapture"])
        .env(PORT, link)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
#[ignore = "a test starts it, as a process"]
fn command() {
    let Ok(port) = std::env::var(PORT) else {
        return;
    };
    let file = five_class_path();
    let line = ["myointent", "board", "--port", &port, "install"];
    let line = line.into_iter().chain(file.to_str());
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}

#[test]
fn a_process_that_is_killed_at_random_moments_is_started_again_and_completes_the_model() {
    const KILLS: usize = 30;
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let (board, flash) = Board::on(&link, flash_of(&shipped()), Vec::new());
    let mut random = ChaCha8Rng::seed_from_u64(41);
    let all = new.len() / BLOCK_BYTES * BLOCK_LINES;
    let mut alive = 0;
    for _ in 0..KILLS {
        // Kills fall from the first byte of the first command on. They are counted in bytes of the line, which no load
        // of the machine moves.
        let until = board.passed() + random.random_range(0..all / KILLS);
        let mut process = start(&link);
        while board.passed() < until && process.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(100));
        }
        alive += usize::from(process.try_wait().unwrap().is_none());
        process.kill().unwrap();
        process.wait().unwrap();
    }
    assert_eq!(alive, KILLS, "it ended by itself");
    assert!(!flash.lock().unwrap().region.starts_with(&new));
    let ended = start(&link).wait_with_output().unwrap();
    assert!(ended.status.success());
    let said = String::from_utf8(ended.stdout).unwrap();
    let checksum = ModelFile::new(&new).unwrap().checksum();
    let expected = format!("installed and in use: model {checksum:08x}");
    assert!(said.contains(&expected), "{said}");
    assert!(flash.lock().unwrap().region.starts_with(&new));
    // Only blocks that were on their way when a process was killed are sent twice: a block or two.
    let most = all * 21 / 20 + KILLS * 3 * BLOCK_LINES;
    assert!(
        board.passed() < most,
        "{} bytes, not {most}",
        board.passed()
    );
    assert_eq!(board.off(), 0);
}

#[test]
fn an_answer_to_a_block_that_was_sent_twice_is_no_refusal_to_begin_again() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let terminal = Terminal::new(&link);
    let new = five_class();
    let file = ModelFile::new(&new).unwrap();
    let checksum = file.checksum();
    // The board restarts before the first block, and is so slow that the block has come twice.
    let board = std::thread::spawn(move || {
        let mut reader = CommandReader::new();
        let mut blocks = 0;
        while blocks < 2 {
            let mut buffer = [0; 256];
            let length = terminal.master.read(&mut buffer).unwrap_or(0);
            for &byte in &buffer[..length] {
                let answers = match reader.push(byte) {
                    None => continue,
                    Some(Ok(Command::Install(_))) => {
                        vec![Answer::Install(InstallationProgress::Next(0))]
                    }
                    Some(Ok(Command::Block(..))) if blocks == 0 => {
                        blocks += 1;
                        vec![Answer::Refused(Refusal::NotBegun); 2]
                    }
                    Some(Ok(Command::Identify)) => {
                        blocks += 1;
                        vec![identity(checksum)]
                    }
                    Some(_) => vec![Answer::Install(InstallationProgress::Installed)],
                };
                for answer in answers {
                    let answer = answer.to_string();
                    terminal.master.write_all(answer.as_bytes()).unwrap();
                }
            }
        }
        terminal
    });
    let installed = install(&link, file, || false, |_| ());
    assert!(installed.is_ok(), "{installed:?}");
    board.join().unwrap();
}

/// Installs on a board whose answers are scripted, and stops after half a minute. Returns the result, and the number of
/// commands that the board was sent.
fn installed(
    lines: impl FnMut(Command) -> String + Send + 'static,
) -> (Result<(), BoardError>, usize) {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Scripted::start(&link, lines);
    let new = five_class();
    let end = Instant::now() + Duration::from_secs(30);
    let over = || Instant::now() > end;
    let ended = install(&link, ModelFile::new(&new).unwrap(), over, |_| ());
    (ended, board.end())
}

/// Returns the error's text, and the number of commands that the board was sent.
fn refused(lines: impl FnMut(Command) -> String + Send + 'static) -> (String, usize) {
    let (ended, commands) = installed(lines);
    (ended.unwrap_err().to_string(), commands)
}

fn next(block: u32) -> String {
    Answer::Install(InstallationProgress::Next(block)).to_string()
}

fn done() -> String {
    Answer::Install(InstallationProgress::Installed).to_string()
}

#[test]
fn a_late_done_of_another_installation_is_not_taken_for_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let file = ModelFile::new(&new).unwrap();
    // The late answer comes before that to the first command, to the first block, in the middle, to the last block.
    for at in [0, 1, 700, file.blocks() as usize] {
        let (board, flash) = Board::late(
            &link,
            flash_of(&shipped()),
            at,
            InstallationProgress::Installed,
        );
        install(&link, file, || false, |_| ()).unwrap();
        assert!(flash.lock().unwrap().region.starts_with(&new), "{at}");
        board.off();
    }
}

#[test]
fn a_board_that_says_done_and_runs_another_model_has_not_installed_it() {
    let (said, commands) = refused(|command| match command {
        Command::Identify => identity(7).to_string(),
        _ => done(),
    });
    assert!(said.contains("00000007"), "{said}");
    assert!(commands < 50, "{commands}");
}

#[test]
fn a_board_that_restarts_at_each_block_is_given_up_with_words() {
    let (said, commands) = refused(|command| match command {
        Command::Install(_) => next(0),
        _ => Answer::Refused(Refusal::NotBegun).to_string(),
    });
    assert!(said.contains("restart"), "{said}");
    assert!(commands < 50, "{commands}");
}

#[test]
fn a_board_that_restarts_in_the_middle_of_each_page_is_given_up_with_words() {
    let mut since = 0;
    let (said, commands) = refused(move |command| match command {
        Command::Install(_) => {
            since = 0;
            next(0)
        }
        Command::Block(0, _) => next(64),
        Command::Block(number, _) if since < 30 => {
            since += 1;
            next(number + 1)
        }
        _ => Answer::Refused(Refusal::NotBegun).to_string(),
    });
    assert!(said.contains("restart"), "{said}");
    assert!(commands < 1000, "{commands}");
}

#[test]
fn a_board_that_asks_for_the_same_blocks_again_and_again_is_given_up_with_words() {
    let (said, commands) = refused(|command| match command {
        Command::Block(number, _) => next(64 + (number + 1) % 3),
        _ => next(0),
    });
    assert!(said.contains("again"), "{said}");
    assert!(commands < 2000, "{commands}");
}

#[test]
fn a_file_that_no_board_can_run_is_refused_before_anything_is_sent() {
    let new = five_class();
    let mut damaged = new.clone();
    damaged[1000] ^= 1;
    let mut version = new.clone();
    version[8] += 1;
    for wrong in [
        &damaged[..],
        &version,
        &new[..new.len() - 1],
        b"",
        b"a file",
    ] {
        assert!(matches!(ModelFile::new(wrong), Err(InstallError::Unfit(_))));
    }
    assert!(ModelFile::new(&new).is_ok());
}

#[test]
fn a_model_that_is_in_use_is_not_sent_and_a_missing_port_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let (_board, _) = Board::on(&link, flash_of(&new), Vec::new());
    let file = ModelFile::new(&new).unwrap();
    let mut reports = Vec::new();
    install(&link, file, || false, |blocks| reports.push(blocks)).unwrap();
    assert_eq!(reports, [file.blocks()]);
    let missing = install("/no/such/port".as_ref(), file, || false, |_| {});
    assert!(matches!(missing, Err(BoardError::Open { .. })));
}
