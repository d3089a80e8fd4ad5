//! Installations on boards without a line, in virtual time: cut, restarted, and told wrong things.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::uart_line::answer::Identity;
use shared::uart_line::line::LineReader;

use super::*;

/// Five-class model.
const FIVE_CLASS: &[u8] = models::SHIPPED[1].1;

/// Answer to `IDENTIFY` of a board with this model.
pub(crate) fn identity(model: Option<u32>) -> Answer<'static> {
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
    let (mut reader, mut commands) = (LineReader::default(), 0);
    let mut now = Millis(0);
    loop {
        while let Some(command) = installer.command(now) {
            commands += 1;
            let Some(lines) = board(command) else {
                reader = LineReader::default();
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
    let (end, _, commands) = run(FIVE_CLASS, |command| Some(board(command).to_string()));
    (end.unwrap_err().to_string(), commands)
}

/// Board that takes a model page by page; the first page is the last, but for its first block, which begins each time.
struct Board<'f> {
    file: &'f [u8],
    /// Number of pages that it has, and the block that it wants; none before a begin.
    pages: u32,
    wanted: Option<u32>,
    is_installed: bool,
}

impl<'f> Board<'f> {
    const PAGE: u32 = (PAGE_BYTES / BLOCK_BYTES) as u32;

    const fn new(file: &'f [u8]) -> Self {
        Self {
            file,
            pages: 0,
            wanted: None,
            is_installed: false,
        }
    }

    fn answer(&mut self, command: Command) -> Answer<'static> {
        let file = ModelFile::new(self.file).unwrap();
        match command {
            Command::Identify => {
                return identity(Some(if self.is_installed {
                    file.checksum()
                } else {
                    7
                }));
            }
            Command::Install(_) => self.wanted = Some(0),
            Command::Block(number, block) if self.wanted == Some(number) => {
                assert_eq!(block, Block::of(self.file, number));
                let next = number + 1;
                let is_last = next.is_multiple_of(Self::PAGE) || next == file.blocks();
                self.pages += u32::from(is_last);
                let all = file.blocks().div_ceil(Self::PAGE);
                self.is_installed = self.pages == all;
                self.wanted = Some(match (self.pages + 1) % all {
                    _ if number > 0 && !is_last => next,
                    0 => 1,
                    page => page * Self::PAGE,
                });
            }
            _ => {}
        }
        match self.wanted {
            None => Answer::Refused(Refusal::NotBegun),
            Some(_) if self.is_installed => Answer::Install(InstallationProgress::Installed),
            Some(block) => Answer::Install(InstallationProgress::Next(block)),
        }
    }
}

#[test]
fn a_model_is_installed_though_power_and_line_are_cut_at_100_random_moments() {
    let new = FIVE_CLASS;
    let mut board = Board::new(new);
    let mut random = ChaCha8Rng::seed_from_u64(17);
    // A page has 64 blocks and is written again from its start: about one life in twenty is long enough for a page, with
    // approximately 125 bytes for a block's line and its answer.
    let mut lives = (0..100).map(|_| random.random_range(0..64 * 125 * 17 / 16));
    let mut left: usize = lives.next().unwrap();
    let mut cuts = 0;
    let mut furthest = None;
    // Where the installation has given up it is begun again, as a person would.
    let installed = (0..200).any(|_| {
        let (end, blocks, _) = run(new, |command| {
            let carried = command.to_string().len();
            let answer = (carried <= left).then(|| board.answer(command).to_string());
            let all = carried + answer.as_ref().map_or(0, String::len);
            if let Some(rest) = left.checked_sub(all) {
                left = rest;
                return answer;
            }
            cuts += 1;
            left = lives.next().unwrap_or(usize::MAX);
            // It has lost its power: of a page in progress nothing is left.
            board.wanted = None;
            None
        });
        furthest = furthest.max(blocks);
        end.is_ok()
    });
    assert!(installed);
    assert_eq!(cuts, 100);
    assert_eq!(furthest, Some(ModelFile::new(new).unwrap().blocks()));
    assert!(board.is_installed);
}

#[test]
fn late_answers_to_others_are_not_taken_for_the_end() {
    let new = FIVE_CLASS;
    let blocks = ModelFile::new(new).unwrap().blocks() as usize;
    // The late answer comes before that to the first command, to the first block, in the middle, to the last block.
    for at in [0, 1, 700, blocks] {
        let (mut board, mut number) = (Board::new(new), 0);
        let (end, ..) = run(new, |command| {
            let late = Answer::Install(InstallationProgress::Installed).to_string();
            let late = if number == at { late } else { String::new() };
            number += 1;
            Some(late + &board.answer(command).to_string())
        });
        assert_eq!(end, Ok(()));
        assert!(board.is_installed, "{at}");
    }
    // A board restarts before the first block, and is so slow that the block comes twice.
    let checksum = ModelFile::new(new).unwrap().checksum();
    let mut has_restarted = false;
    let (end, ..) = run(new, |command| {
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
    let new = FIVE_CLASS;
    let [mut damaged, mut version] = [new.to_vec(), new.to_vec()];
    damaged[1000] ^= 1;
    version[8] += 1;
    for wrong in [
        &damaged[..],
        &version,
        &new[..new.len() - 1],
        b"",
        b"a file",
    ] {
        assert!(matches!(
            ModelFile::new(wrong),
            Err(InstallError::Unfit { .. })
        ));
    }
}
