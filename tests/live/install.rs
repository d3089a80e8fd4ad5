//! A model for a board on a pseudo-terminal, whose line is cut at random moments.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use myointent::board::{BoardError, ModelFile, Unfit, install};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serial2::SerialPort;
use shared::installation::journal::{self, JOURNAL_BYTES};
use shared::installation::{BLOCK_BYTES, Installation, PAGE_BYTES, Progress, Refused, Step};
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;
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
    thread: JoinHandle<usize>,
}

impl Board {
    /// It loses its power after each of `lives`, which are in bytes of its line, both ways: a cut that no load of the machine moves.
    /// Once they are over it stays on.
    fn on(link: &Path, flash: Flash, lives: Vec<usize>) -> (Self, Arc<Mutex<Flash>>) {
        let flash = Arc::new(Mutex::new(flash));
        let stop = Arc::new(AtomicBool::new(false));
        let first = Terminal::new(link);
        let thread = {
            let (stop, flash, link) = (stop.clone(), flash.clone(), link.to_owned());
            std::thread::spawn(move || {
                let mut terminal = first;
                let mut cuts = 0;
                let lives = lives.into_iter().chain([usize::MAX]);
                for life in lives {
                    let mut line = Line {
                        port: &terminal.master,
                        left: life,
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
        (Self { stop, thread }, flash)
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
}

impl Line<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let length = buffer.len().min(self.left);
        let length = self.port.read(&mut buffer[..length]).unwrap_or(0);
        self.left -= length;
        length
    }

    fn write(&mut self, bytes: &[u8]) {
        let length = bytes.len().min(self.left);
        let _ = self.port.write_all(&bytes[..length]);
        self.left -= length;
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
                        let success = match step {
                            Step::Suspend => {
                                in_use = None;
                                true
                            }
                            Step::Verify => checksum(flash).is_some(),
                            Step::Resume => {
                                in_use = checksum(flash);
                                true
                            }
                            _ => write(&installation, flash, step),
                        };
                        taken = installation.done(success);
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
            line.write(answer.to_string().as_bytes());
        }
    }
}

fn write(installation: &Installation, flash: &mut Flash, step: Step) -> bool {
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
    true
}

fn five_class() -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent");
    std::fs::read(path).unwrap()
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
        assert!(matches!(ModelFile::new(wrong), Err(Unfit::Model(_))));
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
