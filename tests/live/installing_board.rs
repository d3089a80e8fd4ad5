//! Board at a pseudo-terminal that takes a model, and loses its power.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use serial2::SerialPort;
use shared::installation::journal::{self, JOURNAL_BYTES};
use shared::installation::{
    BLOCK_BYTES, Installation, InstallationProgress, InstallationStep, PAGE_BYTES, Refused,
};
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{Command, CommandReader};

use super::board::Terminal;
use super::scripted::identity;

const REGION: usize = 40 * PAGE_BYTES;

/// State that outlasts a loss of power.
pub(super) struct Flash {
    pub(super) region: Vec<u8>,
    pub(super) journal: [u8; JOURNAL_BYTES],
}

/// Board at a terminal, until it is dropped.
pub(super) struct Board {
    stop: Arc<AtomicBool>,
    /// Bytes of the board's line so far, in both directions.
    passed: Arc<AtomicUsize>,
    thread: JoinHandle<usize>,
}

impl Board {
    /// Plays a board that loses its power after each of `lives`, and then stays on. Each is a number of bytes of its
    /// line in both directions: the machine's load moves no cut.
    pub(super) fn on(link: &Path, flash: Flash, lives: Vec<usize>) -> (Self, Arc<Mutex<Flash>>) {
        Self::play(link, flash, lives, None)
    }

    /// Plays a board that, before the answer to the command with this number, writes the answer to another program's
    /// command.
    pub(super) fn late(
        link: &Path,
        flash: Flash,
        at: usize,
        answer: InstallationProgress,
    ) -> (Self, Arc<Mutex<Flash>>) {
        Self::play(link, flash, Vec::new(), Some((at, answer)))
    }

    fn play(
        link: &Path,
        flash: Flash,
        lives: Vec<usize>,
        late: Option<(usize, InstallationProgress)>,
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
                    // This closes the old terminal: whoever writes to it learns of the cut.
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

    pub(super) fn passed(&self) -> usize {
        self.passed.load(Ordering::Relaxed)
    }

    /// Switches the board off; returns the number of times that it had lost its power.
    pub(super) fn off(self) -> usize {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}

/// Line of a board while it has power.
struct Line<'t> {
    port: &'t SerialPort,
    left: usize,
    passed: &'t AtomicUsize,
    /// Commands until the answer to another command comes, and that answer.
    late: Option<(usize, InstallationProgress)>,
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
                    Ok(InstallationProgress::Installed)
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
                            InstallationStep::Suspend => in_use = None,
                            InstallationStep::Verify if checksum(flash).is_none() => {
                                outcome = Err(Refused::Model);
                            }
                            InstallationStep::Resume => in_use = checksum(flash),
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

fn write(installation: &Installation, flash: &mut Flash, step: InstallationStep) {
    match step {
        InstallationStep::EraseJournal | InstallationStep::EndJournal => flash.journal.fill(0xff),
        InstallationStep::WriteJournal => {
            flash.journal[..16].copy_from_slice(&installation.record())
        }
        InstallationStep::MarkPage(page) => {
            flash.journal[journal::mark(page) as usize..][..4].fill(0)
        }
        InstallationStep::ErasePage(page) => {
            flash.region[page as usize * PAGE_BYTES..][..PAGE_BYTES].fill(0xff);
        }
        InstallationStep::WriteBlock(number) => flash.region[number as usize * BLOCK_BYTES..]
            [..BLOCK_BYTES]
            .copy_from_slice(&installation.content().0),
        InstallationStep::Suspend | InstallationStep::Verify | InstallationStep::Resume => {}
    }
}

pub(super) fn flash_of(model: &[u8]) -> Flash {
    let mut region = model.to_vec();
    region.resize(REGION, 0xff);
    Flash {
        region,
        journal: [0xff; JOURNAL_BYTES],
    }
}
