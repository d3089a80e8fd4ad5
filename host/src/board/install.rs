//! Installs a model on a board: sends the blocks that it asks for, and continues after a break.

use std::path::Path;
use std::time::{Duration, Instant};

use shared::installation::{BLOCK_BYTES, Block, PAGE_BYTES, Progress, Transfer};
use shared::model::encoder::DeviceEncoder;
use shared::model::file::Model;
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;
use shared::uf2::MODEL_REGION;

use super::{Board, BoardError};

/// Time without progress after which a lost board is given up.
const PATIENCE: Duration = Duration::from_secs(30);
/// Begins without progress after which a board is given up: it restarts each time.
const MOST_BEGINS: u32 = 10;
/// Blocks without progress after which a board is given up. After a begin, the first block and those of one page are sent
/// again.
const MOST_BLOCKS: u32 = MOST_BEGINS * (1 + (PAGE_BYTES / BLOCK_BYTES) as u32);
/// Number of times a board may report a finished installation while it runs another model: late answers to other blocks.
const MOST_DOUBTS: u32 = 3;
/// Pause between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(100);

/// Model file that a board can run.
#[derive(Clone, Copy, Debug)]
pub struct ModelFile<'f> {
    bytes: &'f [u8],
    transfer: Transfer,
}

impl<'f> ModelFile<'f> {
    /// Checks a file as a board does.
    ///
    /// # Errors
    /// When a board would refuse the file.
    pub fn new(bytes: &'f [u8]) -> Result<Self, BoardError> {
        let model = Model::parse(bytes)?;
        DeviceEncoder::new(&model)?;
        let bytes = &bytes[..model.length];
        let checksum = bytes.last_chunk().copied().unwrap_or_default();
        match u32::try_from(bytes.len()) {
            Ok(length) if bytes.len() <= MODEL_REGION.len() => Ok(Self {
                bytes,
                transfer: Transfer {
                    length,
                    checksum: u32::from_le_bytes(checksum),
                },
            }),
            _ => Err(BoardError::Long {
                length: bytes.len(),
            }),
        }
    }

    /// The file, without bytes behind its end.
    #[must_use]
    pub const fn bytes(&self) -> &'f [u8] {
        self.bytes
    }

    /// CRC-32 of the file.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        self.transfer.checksum
    }

    /// Number of blocks of the file.
    #[must_use]
    pub const fn blocks(&self) -> u32 {
        self.transfer.blocks()
    }
}

/// Installs a model on the board at a port. `report` gets the number of blocks that the board has. A lost board is
/// searched for and the installation continues, until there was no progress for 30 s or for ten begins. It ends early
/// once `stopped` returns true. It succeeds once the board reports that it runs the model.
///
/// # Errors
/// There is no board, it refuses, it is lost or makes no progress, it runs another model in the end, or `stopped`
/// returned true. A new call continues where this one ended.
pub fn install(
    path: &Path,
    file: ModelFile<'_>,
    stopped: impl Fn() -> bool,
    mut report: impl FnMut(u32),
) -> Result<(), BoardError> {
    let mut board = Board::open(path)?;
    let mut budget = RetryBudget::new(file.blocks());
    loop {
        match board.send_model(file, &stopped, &mut budget, &mut report) {
            Err(error @ (BoardError::Lost { .. } | BoardError::Silent { .. })) => {
                // Tries until the board answers again or the time is over.
                board = loop {
                    if budget.is_exhausted() {
                        return Err(error);
                    }
                    if stopped() {
                        return Err(BoardError::Stopped);
                    }
                    std::thread::sleep(AGAIN);
                    if let Ok(board) = Board::open(path) {
                        break board;
                    }
                };
            }
            sent => return sent,
        }
    }
}

/// Commands sent since the board last made progress.
struct RetryBudget {
    /// Number of blocks in the file.
    of: u32,
    /// Greatest number of blocks that the board had; none before its first answer.
    furthest: Option<u32>,
    since: Instant,
    begins: u32,
    blocks: u32,
}

impl RetryBudget {
    fn new(of: u32) -> Self {
        Self {
            of,
            furthest: None,
            since: Instant::now(),
            begins: 0,
            blocks: 0,
        }
    }

    /// Records that the board has this many blocks.
    fn reached(&mut self, blocks: u32) {
        if self.furthest.is_none_or(|furthest| blocks > furthest) {
            *self = Self {
                furthest: Some(blocks),
                ..Self::new(self.of)
            };
        }
    }

    /// Counts a begin of the installation.
    fn begin(&mut self) -> Result<(), BoardError> {
        self.begins += 1;
        self.check()
    }

    /// Counts a block.
    fn block(&mut self) -> Result<(), BoardError> {
        self.blocks += 1;
        self.check()
    }

    const fn check(&self) -> Result<(), BoardError> {
        if self.begins <= MOST_BEGINS && self.blocks <= MOST_BLOCKS {
            return Ok(());
        }
        let furthest = match self.furthest {
            Some(furthest) => furthest,
            None => 0,
        };
        Err(BoardError::NoProgress {
            furthest,
            of: self.of,
            begins: self.begins,
        })
    }

    /// Whether to give up a lost board.
    fn is_exhausted(&self) -> bool {
        self.furthest.is_none() || self.since.elapsed() > PATIENCE
    }
}

impl Board {
    /// Sends the blocks that the board asks for, until it runs the model.
    fn send_model(
        &mut self,
        file: ModelFile<'_>,
        stopped: &impl Fn() -> bool,
        budget: &mut RetryBudget,
        report: &mut impl FnMut(u32),
    ) -> Result<(), BoardError> {
        let mut progress = self.begin(file, budget)?;
        let mut may_begin_again = true;
        let mut doubts = 0;
        loop {
            if stopped() {
                return Err(BoardError::Stopped);
            }
            let Progress::Next(number) = progress else {
                let found = self.ask(Command::Identify, |answer| match answer {
                    Answer::Identity(identity) => Some(identity.model),
                    _ => None,
                })?;
                if found == Some(file.checksum()) {
                    break;
                }
                // The answer belonged to another program's block, or was late.
                doubts += 1;
                if doubts > MOST_DOUBTS {
                    let expected = file.checksum();
                    return Err(BoardError::OtherModel { expected, found });
                }
                progress = self.begin(file, budget)?;
                continue;
            };
            // A board never asks for a block past the end. If one did, it would refuse the block sent here.
            let before = file.transfer.before(number.min(file.blocks()));
            budget.reached(before);
            budget.block()?;
            report(before);
            let block = Command::Block(number, Block::of(file.bytes, number));
            let answer = self.ask(block, |answer| {
                // A board never asks for the block that it has just taken: this answers an earlier line.
                missing(answer).filter(|progress| *progress != Progress::Next(number))
            });
            progress = match answer {
                // The board has restarted.
                Err(BoardError::Refused(Refusal::NotBegun)) => self.begin(file, budget)?,
                // The old content of its flash does not match its journal.
                Err(BoardError::Refused(Refusal::Model)) if number != 0 && may_begin_again => {
                    may_begin_again = false;
                    self.begin(file, budget)?
                }
                Err(BoardError::Refused(Refusal::Model)) => {
                    let reason = self.reason.take();
                    return Err(BoardError::Model {
                        reason: reason.unwrap_or_else(|| "nothing".to_owned()),
                    });
                }
                answer => answer?,
            };
        }
        report(file.blocks());
        Ok(())
    }

    /// Begins or continues the installation; returns what is missing.
    fn begin(
        &mut self,
        file: ModelFile<'_>,
        budget: &mut RetryBudget,
    ) -> Result<Progress, BoardError> {
        budget.begin()?;
        self.ask(Command::Install(file.transfer), missing)
    }
}

const fn missing(answer: &Answer<'_>) -> Option<Progress> {
    match answer {
        Answer::Install(progress) => Some(*progress),
        _ => None,
    }
}
