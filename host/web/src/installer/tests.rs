//! Installations on boards without a line, in virtual time: cut, restarted, and told wrong things.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::installation::journal::{self, JOURNAL_BYTES};
use shared::installation::{Installation, InstallationStep, Refused};
use shared::uart_line::answer::Identity;
use shared::uart_line::line::LineReader;

use super::*;
use crate::SHIPPED;

const REGION: usize = 40 * PAGE_BYTES;

/// Five-class model, on the heap, which aligns it as a model requires.
fn five_class() -> Vec<u8> {
    models::SHIPPED[1].1.to_vec()
}

/// Answer to `IDENTIFY` of a board with this model.
fn identity(model: Option<u32>) -> Answer<'static> {
    Answer::Identity(Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "test",
        model,
        armband: None,
        firmware: None,
        battery: None,
    })
}

/// Runs an installation with what a board writes for a command; none if power or line are lost instead. Returns its end, the
/// greatest number of blocks, and the number of commands.
fn run(
    file: &[u8],
    mut board: impl FnMut(Command) -> Option<String>,
) -> (Result<(), InstallError>, Option<u32>, usize) {
    let mut installer = Installer::new(ModelFile::new(file).unwrap(), Millis(0));
    let (mut reader, mut commands) = (LineReader::new(), 0);
    let mut now = Millis(0);
    loop {
        while let Some(command) = installer.command(now) {
            commands += 1;
            let Some(lines) = board(command) else {
                reader = LineReader::new();
                installer.connected(now);
                continue;
            };
            for byte in lines.bytes() {
                if let Some(Ok(line)) = reader.push(byte) {
                    installer.line(now, &line);
                }
            }
        }
        if let Some(end) = installer.end() {
            return (end.clone(), installer.blocks(), commands);
        }
        now = now.plus(10);
    }
}

/// Returns the error's text, and the number of commands that the board was sent.
fn refused(mut board: impl FnMut(Command) -> Answer<'static>) -> (String, usize) {
    let (end, _, commands) = run(&five_class(), |command| Some(board(command).to_string()));
    (end.unwrap_err().to_string(), commands)
}

/// Board that takes a model.
struct Board {
    region: Vec<u8>,
    journal: [u8; JOURNAL_BYTES],
    installation: Installation,
    in_use: Option<u32>,
}

impl Board {
    fn new() -> Self {
        let mut region = SHIPPED.to_vec();
        region.resize(REGION, 0xff);
        let mut board = Self {
            region,
            journal: [0xff; JOURNAL_BYTES],
            installation: Installation::new(REGION as u32),
            in_use: None,
        };
        board.in_use = board.checksum();
        board
    }

    /// Loses its power, and starts again.
    fn restart(&mut self) {
        self.installation = Installation::new(REGION as u32);
        self.in_use = self.checksum();
    }

    fn checksum(&self) -> Option<u32> {
        Some(Model::parse(&self.region).ok()?.checksum)
    }

    fn answer(&mut self, command: Command) -> Answer<'static> {
        let taken = match command {
            Command::Identify => return identity(self.in_use),
            Command::Install(transfer) if self.in_use == Some(transfer.checksum) => {
                Ok(InstallationProgress::Installed)
            }
            Command::Install(transfer) => {
                let journal = journal::read(&self.journal).filter(|_| self.in_use.is_none());
                let begun = self.installation.begin(transfer, journal);
                begun.map_err(|_| Refusal::Length)
            }
            Command::Block(number, block) => {
                let is_ours = |block: &Block| {
                    matches!(Model::parse(&block.0), Err(ModelError::Length { .. }))
                };
                let mut taken = self.installation.take(number, &block, is_ours);
                while let (Ok(()), Some(step)) = (taken, self.installation.step()) {
                    let outcome = self.step(step);
                    taken = self.installation.done(outcome);
                }
                let taken = taken.map(|()| self.installation.progress());
                taken.map_err(|refused| match refused {
                    Refused::NotBegun => Refusal::NotBegun,
                    Refused::Model => Refusal::Model,
                    _ => Refusal::Arguments,
                })
            }
            _ => Err(Refusal::Unknown),
        };
        taken.map_or_else(Answer::Refused, Answer::Install)
    }

    fn step(&mut self, step: InstallationStep) -> Result<(), Refused> {
        match step {
            InstallationStep::Suspend => self.in_use = None,
            InstallationStep::Resume => self.in_use = self.checksum(),
            InstallationStep::Verify => {
                self.checksum().ok_or(Refused::Model)?;
            }
            InstallationStep::EraseJournal | InstallationStep::EndJournal => {
                self.journal.fill(0xff)
            }
            InstallationStep::WriteJournal => {
                self.journal[..16].copy_from_slice(&self.installation.record());
            }
            InstallationStep::MarkPage(page) => {
                self.journal[journal::mark(page) as usize..][..4].fill(0);
            }
            InstallationStep::ErasePage(page) => {
                self.region[page as usize * PAGE_BYTES..][..PAGE_BYTES].fill(0xff);
            }
            InstallationStep::WriteBlock(number) => {
                let block = &mut self.region[number as usize * BLOCK_BYTES..][..BLOCK_BYTES];
                block.copy_from_slice(&self.installation.content().0);
            }
        }
        Ok(())
    }
}

#[test]
fn a_model_is_installed_though_power_and_line_are_cut_at_100_random_moments() {
    let new = five_class();
    let mut board = Board::new();
    let mut random = ChaCha8Rng::seed_from_u64(17);
    // A page has 64 blocks and is written again from its start: about one life in twenty is long enough for a page, with
    // approximately 125 bytes for a block's line and its answer.
    let mut lives = (0..100).map(|_| random.random_range(0..64 * 125 * 17 / 16));
    let mut left: usize = lives.next().unwrap();
    let mut cuts = 0;
    let mut furthest = None;
    // Where the installation has given up it is begun again, as a person would.
    let installed = (0..200).any(|_| {
        let (end, blocks, _) = run(&new, |command| {
            let carried = command.to_string().len();
            let answer = (carried <= left).then(|| board.answer(command).to_string());
            let all = carried + answer.as_ref().map_or(0, String::len);
            if let Some(rest) = left.checked_sub(all) {
                left = rest;
                return answer;
            }
            cuts += 1;
            left = lives.next().unwrap_or(usize::MAX);
            board.restart();
            None
        });
        furthest = furthest.max(blocks);
        end.is_ok()
    });
    assert!(installed);
    assert_eq!(cuts, 100);
    assert_eq!(furthest, Some(ModelFile::new(&new).unwrap().blocks()));
    assert!(board.region.starts_with(&new));
}

#[test]
fn late_answers_to_others_are_not_taken_for_the_end() {
    let new = five_class();
    let blocks = ModelFile::new(&new).unwrap().blocks() as usize;
    // The late answer comes before that to the first command, to the first block, in the middle, to the last block.
    for at in [0, 1, 700, blocks] {
        let (mut board, mut number) = (Board::new(), 0);
        let (end, ..) = run(&new, |command| {
            let late = Answer::Install(InstallationProgress::Installed).to_string();
            let late = if number == at { late } else { String::new() };
            number += 1;
            Some(late + &board.answer(command).to_string())
        });
        assert_eq!(end, Ok(()));
        assert!(board.region.starts_with(&new), "{at}");
    }
    // A board restarts before the first block, and is so slow that the block comes twice.
    let checksum = ModelFile::new(&new).unwrap().checksum();
    let mut has_restarted = false;
    let (end, ..) = run(&new, |command| {
        Some(match command {
            Command::Install(_) => Answer::Install(InstallationProgress::Next(0)).to_string(),
            Command::Identify => identity(Some(checksum)).to_string(),
            _ if std::mem::replace(&mut has_restarted, true) => {
                Answer::Install(InstallationProgress::Installed).to_string()
            }
            _ => Answer::Refused(Refusal::NotBegun).to_string().repeat(2),
        })
    });
    assert_eq!(end, Ok(()));
}

#[test]
fn a_board_that_gets_no_further_or_runs_another_model_is_given_up_with_words() {
    let next = |block| Answer::Install(InstallationProgress::Next(block));
    let (said, commands) = refused(|command| match command {
        Command::Identify => identity(Some(7)),
        _ => Answer::Install(InstallationProgress::Installed),
    });
    assert!(
        said.contains("00000007") && commands < 50,
        "{commands}: {said}"
    );
    // It restarts at each block.
    let (said, commands) = refused(|command| match command {
        Command::Install(_) => next(0),
        _ => Answer::Refused(Refusal::NotBegun),
    });
    assert!(
        said.contains("restart") && commands < 50,
        "{commands}: {said}"
    );
    // It restarts in the middle of each page.
    let mut since = 0;
    let (said, commands) = refused(|command| {
        since += 1;
        match command {
            Command::Install(_) => {
                since = 0;
                next(0)
            }
            Command::Block(0, _) => next(64),
            Command::Block(number, _) if since < 30 => next(number + 1),
            _ => Answer::Refused(Refusal::NotBegun),
        }
    });
    assert!(
        said.contains("restart") && commands < 1000,
        "{commands}: {said}"
    );
    // It asks for the same blocks again and again.
    let (said, commands) = refused(|command| match command {
        Command::Block(number, _) => next(64 + (number + 1) % 3),
        _ => next(0),
    });
    assert!(
        said.contains("again") && commands < 2000,
        "{commands}: {said}"
    );
}

#[test]
fn a_file_that_no_board_can_run_is_refused_before_anything_is_sent() {
    let new = five_class();
    let [mut damaged, mut version] = [new.clone(), new.clone()];
    damaged[1000] ^= 1;
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
}
