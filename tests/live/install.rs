//! A model for a board on a pseudo-terminal, whose line is cut, or whose program on the PC is killed, at random moments.

use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, ExitCode, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use clap::Parser as _;
use myointent::board::{BoardError, ModelFile, install};
use myointent::cli::Cli;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serial2::SerialPort;
use shared::installation::journal::{self, JOURNAL_BYTES};
use shared::installation::{BLOCK_BYTES, Installation, PAGE_BYTES, Progress, Refused, Step};
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;
use super::scripted::{Scripted, identity};
use super::shipped;

const REGION: usize = 40 * PAGE_BYTES;
/// Bytes of a block's line and of its answer, about.
const BLOCK_LINES: usize = 125;

/// What outlasts a loss of power.
struct Flash {
    region: Vec<u8>,
    journal: [u8; JOURNAL_BYTES],
}

/// A board at a terminal, until it is dropped.
struct Board {
    stop: Arc<AtomicBool>,
    /// Bytes of its line so far, both ways.
    passed: Arc<AtomicUsize>,
    thread: JoinHandle<usize>,
}

impl Board {
    /// It loses its power after each of `lives`, which are in bytes of its line, both ways: a cut that no load of the machine moves.
    /// Once they are over it stays on.
    fn on(link: &Path, flash: Flash, lives: Vec<usize>) -> (Self, Arc<Mutex<Flash>>) {
        Self::play(link, flash, lives, None)
    }

    /// Before the answer to the command with this number it answers one that somebody else has sent.
    fn late(link: &Path, flash: Flash, at: usize, answer: Progress) -> (Self, Arc<Mutex<Flash>>) {
        Self::play(link, flash, Vec::new(), Some((at, answer)))
    }

    fn play(
        link: &Path,
        flash: Flash,
        lives: Vec<usize>,
        late: Option<(usize, Progress)>,
    ) -> (Self, Arc<Mutex<Flash>>) {
        let flash = Arc::new(Mutex::new(flash));
        let stop = Arc::new(AtomicBool::new(false));
        let passed = Arc::new(AtomicUsize::new(0));
        let first = Terminal::new(link);
        let thread = {
            let (stop, flash, link) = (stop.clone(), flash.clone(), link.to_owned());
            let passed = passed.clone();
            std::thread::spawn(move || {
                let mut terminal = first;
                let mut cuts = 0;
                let lives = lives.into_iter().chain([usize::MAX]);
                for life in lives {
                    let mut line = Line {
                        port: &terminal.master,
                        left: life,
                        passed: &passed,
                        late,
                    };
                    run(&mut line, &stop, &flash);
                    if stop.load(Ordering::Relaxed) {
                        break;
                    }
                    cuts += 1;
                    // The old one is closed by that: whoever writes to it learns of the cut.
                    terminal = Terminal::new(&link);
                }
                cuts
            })
        };
        let board = Self {
            stop,
            passed,
            thread,
        };
        (board, flash)
    }

    fn passed(&self) -> usize {
        self.passed.load(Ordering::Relaxed)
    }

    /// Switches it off: how often it had lost its power.
    fn off(self) -> usize {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}

/// What a board reads and writes while it has power.
struct Line<'t> {
    port: &'t SerialPort,
    left: usize,
    passed: &'t AtomicUsize,
    /// Commands until an answer to another one comes, and that answer.
    late: Option<(usize, Progress)>,
}

impl Line<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let length = buffer.len().min(self.left);
        let length = self.port.read(&mut buffer[..length]).unwrap_or(0);
        self.count(length);
        length
    }

    fn write(&mut self, bytes: &[u8]) {
        let length = bytes.len().min(self.left);
        let _ = self.port.write_all(&bytes[..length]);
        self.count(length);
    }

    fn count(&mut self, bytes: usize) {
        self.left -= bytes;
        self.passed.fetch_add(bytes, Ordering::Relaxed);
    }
}

fn run(line: &mut Line, stop: &AtomicBool, flash: &Mutex<Flash>) {
    let mut installation = Installation::new(REGION as u32);
    let mut reader = CommandReader::new();
    let checksum = |flash: &Flash| {
        let model = Model::parse(&flash.region).ok()?;
        let checksum = flash.region[..model.length].last_chunk::<4>()?;
        Some(u32::from_le_bytes(*checksum))
    };
    let mut in_use = checksum(&flash.lock().unwrap());
    while line.left > 0 && !stop.load(Ordering::Relaxed) {
        let mut buffer = [0; 256];
        let length = line.read(&mut buffer);
        for &byte in &buffer[..length] {
            let Some(command) = reader.push(byte) else {
                continue;
            };
            let flash = &mut *flash.lock().unwrap();
            if command == Ok(Command::Identify) {
                let answer = identity(in_use.unwrap_or(0));
                line.write(answer.to_string().as_bytes());
                continue;
            }
            let answer = match command {
                Ok(Command::Install(transfer)) if in_use == Some(transfer.checksum) => {
                    Ok(Progress::Installed)
                }
                Ok(Command::Install(transfer)) => {
                    let journal = journal::read(&flash.journal).filter(|_| in_use.is_none());
                    let begun = installation.begin(transfer, journal);
                    begun.map_err(|_| Refusal::Length)
                }
                Ok(Command::Block(number, block)) => {
                    let is_ours = |block: &shared::installation::Block| {
                        matches!(Model::parse(&block.0), Err(ModelError::Length { .. }))
                    };
                    let mut taken = installation.take(number, &block, is_ours);
                    while let (Ok(()), Some(step)) = (taken, installation.step()) {
                        let mut outcome = Ok(());
                        match step {
                            Step::Suspend => in_use = None,
                            Step::Verify if checksum(flash).is_none() => {
                                outcome = Err(Refused::Model);
                            }
                            Step::Resume => in_use = checksum(flash),
                            _ => write(&installation, flash, step),
                        }
                        taken = installation.done(outcome);
                    }
                    taken
                        .map(|()| installation.progress())
                        .map_err(|refused| match refused {
                            Refused::NotBegun => Refusal::NotBegun,
                            Refused::Model => Refusal::Model,
                            _ => Refusal::Arguments,
                        })
                }
                Ok(_) => Err(Refusal::Unknown),
                Err(refusal) => Err(refusal),
            };
            let answer = match answer {
                Ok(progress) => Answer::Install(progress),
                Err(refusal) => Answer::Refused(refusal),
            };
            line.late = match line.late {
                Some((0, late)) => {
                    line.write(Answer::Install(late).to_string().as_bytes());
                    None
                }
                Some((before, late)) => Some((before - 1, late)),
                None => None,
            };
            line.write(answer.to_string().as_bytes());
        }
    }
}

fn write(installation: &Installation, flash: &mut Flash, step: Step) {
    match step {
        Step::EraseJournal | Step::EndJournal => flash.journal.fill(0xff),
        Step::WriteJournal => flash.journal[..16].copy_from_slice(&installation.record()),
        Step::MarkPage(page) => flash.journal[journal::mark(page) as usize..][..4].fill(0),
        Step::ErasePage(page) => {
            flash.region[page as usize * PAGE_BYTES..][..PAGE_BYTES].fill(0xff);
        }
        Step::WriteBlock(number) => flash.region[number as usize * BLOCK_BYTES..][..BLOCK_BYTES]
            .copy_from_slice(&installation.content().0),
        Step::Suspend | Step::Verify | Step::Resume => {}
    }
}

fn five_class_path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent")
}

fn five_class() -> Vec<u8> {
    std::fs::read(five_class_path()).unwrap()
}

fn flash_of(model: &[u8]) -> Flash {
    let mut region = model.to_vec();
    region.resize(REGION, 0xff);
    Flash {
        region,
        journal: [0xff; JOURNAL_BYTES],
    }
}

#[test]
fn a_model_is_installed_though_power_and_line_are_cut_at_100_random_moments() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let file = ModelFile::new(&new).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(17);
    // A page has 64 blocks and is written again from its start: about one life in twenty is long enough for one.
    let page = 64 * BLOCK_LINES;
    let lives = (0..100).map(|_| random.random_range(0..page * 17 / 16));
    let (board, flash) = Board::on(&link, flash_of(&shipped()), lives.collect());
    let mut seen = 0;
    // The same command again, as a person gives it, where it has given up.
    let installed =
        (0..200).any(|_| install(&link, file, || false, |blocks| seen = seen.max(blocks)).is_ok());
    assert!(installed);
    assert_eq!(board.off(), 100);
    assert_eq!(seen, file.blocks());
    assert!(flash.lock().unwrap().region.starts_with(&new));
}

/// Set for the process alone: somebody may run all ignored tests.
const PORT: &str = "MYOINTENT_TEST_INSTALL";

/// `myointent board --port LINK install FILE`, as a process of its own.
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
        // From the first byte of the first command on; by the bytes of the line, which no load of the machine moves.
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
    // Nothing is sent twice but what was on its way when a process was killed: a block or two.
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
    // It restarts before the first block and is so slow that the block has come twice.
    let board = std::thread::spawn(move || {
        let mut reader = CommandReader::new();
        let mut blocks = 0;
        while blocks < 2 {
            let mut buffer = [0; 256];
            let length = terminal.master.read(&mut buffer).unwrap_or(0);
            for &byte in &buffer[..length] {
                let answers = match reader.push(byte) {
                    None => continue,
                    Some(Ok(Command::Install(_))) => vec![Answer::Install(Progress::Next(0))],
                    Some(Ok(Command::Block(..))) if blocks == 0 => {
                        blocks += 1;
                        vec![Answer::Refused(Refusal::NotBegun); 2]
                    }
                    Some(Ok(Command::Identify)) => {
                        blocks += 1;
                        vec![identity(checksum)]
                    }
                    Some(_) => vec![Answer::Install(Progress::Installed)],
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

/// Installs on a board whose answers are scripted; it is stopped after half a minute. Gives what came of it, and how many
/// commands it took.
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

/// What a person reads, and how many commands it took.
fn refused(lines: impl FnMut(Command) -> String + Send + 'static) -> (String, usize) {
    let (ended, commands) = installed(lines);
    (ended.unwrap_err().to_string(), commands)
}

fn next(block: u32) -> String {
    Answer::Install(Progress::Next(block)).to_string()
}

fn done() -> String {
    Answer::Install(Progress::Installed).to_string()
}

#[test]
fn a_late_done_of_another_installation_is_not_taken_for_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let new = five_class();
    let file = ModelFile::new(&new).unwrap();
    // Before the answers to the first command, to the first block, in the middle, to the last block.
    for at in [0, 1, 700, file.blocks() as usize] {
        let (board, flash) = Board::late(&link, flash_of(&shipped()), at, Progress::Installed);
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
        assert!(matches!(ModelFile::new(wrong), Err(BoardError::Unfit(_))));
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
