//! A new model for a board: sends the blocks that it asks for, and goes on after a break.

use std::path::Path;
use std::time::{Duration, Instant};

use shared::installation::{Block, Progress, Transfer};
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;

use super::{Board, BoardError};

/// Bytes of a board's flash region, as in `memory.x`.
const REGION_BYTES: usize = 160 * 1024;
/// How long a board that is lost is looked for.
const PATIENCE: Duration = Duration::from_secs(30);
/// Between two looks.
const AGAIN: Duration = Duration::from_millis(100);

/// Why a file is not sent.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// It is no model file, or none that a board has room for.
    #[error("no board can run this file, and nothing was sent: {0}")]
    Model(#[from] ModelError),
    /// It is longer than a board's flash region.
    #[error(
        "{length} bytes, a board has room for {REGION_BYTES}, and nothing was sent: train a smaller model"
    )]
    Length {
        /// Of the file.
        length: usize,
    },
}

/// A file that a board can run.
#[derive(Clone, Copy, Debug)]
pub struct ModelFile<'f> {
    bytes: &'f [u8],
    transfer: Transfer,
}

impl<'f> ModelFile<'f> {
    /// Reads a file as a board does.
    ///
    /// # Errors
    /// For the reasons that a board refuses it for.
    pub fn new(bytes: &'f [u8]) -> Result<Self, Unfit> {
        let model = Model::parse(bytes)?;
        DeviceEncoder::new(&model)?;
        let bytes = &bytes[..model.length];
        let checksum = bytes.last_chunk().copied().unwrap_or_default();
        match u32::try_from(bytes.len()) {
            Ok(length) if bytes.len() <= REGION_BYTES => Ok(Self {
                bytes,
                transfer: Transfer {
                    length,
                    checksum: u32::from_le_bytes(checksum),
                },
            }),
            _ => Err(Unfit::Length {
                length: bytes.len(),
            }),
        }
    }

    /// Its CRC-32.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        self.transfer.checksum
    }

    /// How many blocks it has.
    #[must_use]
    pub const fn blocks(&self) -> u32 {
        self.transfer.blocks()
    }
}

/// Installs a model on the board at a port; `report` is told how many blocks the board has. A board that is lost is looked
/// for, and the installation gone on with, until there was none for 30 s. It ends early once `stopped`.
///
/// # Errors
/// There is no board, it refuses, it is lost or this was stopped: the same call goes on where this one ended.
pub fn install(
    path: &Path,
    file: ModelFile<'_>,
    stopped: impl Fn() -> bool,
    mut report: impl FnMut(u32),
) -> Result<(), BoardError> {
    let mut board = Board::open(path)?;
    let mut furthest = None;
    let mut since = Instant::now();
    loop {
        let sent = board.send_model(file, &stopped, &mut |before| {
            if furthest
                .replace(before)
                .is_none_or(|furthest| furthest != before)
            {
                since = Instant::now();
            }
            report(before);
        });
        match sent {
            Err(error @ (BoardError::Lost { .. } | BoardError::Silent { .. })) => {
                // Until it answers again, or for too long.
                board = loop {
                    if since.elapsed() > PATIENCE || furthest.is_none() {
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

impl Board {
    /// Sends the blocks that the board asks for.
    fn send_model(
        &mut self,
        file: ModelFile<'_>,
        stopped: &impl Fn() -> bool,
        report: &mut impl FnMut(u32),
    ) -> Result<(), BoardError> {
        let begin = Command::Install(file.transfer);
        let mut progress = self.ask(begin, missing)?;
        let mut may_begin_again = true;
        while let Progress::Next(number) = progress {
            if stopped() {
                return Err(BoardError::Stopped);
            }
            // A board asks for no other one; if it does, it is told so.
            report(file.transfer.before(number.min(file.blocks())));
            let block = Command::Block(number, Block::of(file.bytes, number));
            let answer = self.ask(block, |answer| {
                // It never asks for the block that it has just taken: this is the answer to an earlier line.
                missing(answer).filter(|progress| *progress != Progress::Next(number))
            });
            progress = match answer {
                // It has restarted.
                Err(BoardError::Refused(Refusal::NotBegun)) => self.ask(begin, missing)?,
                // What was in its flash before is not what its journal says.
                Err(BoardError::Refused(Refusal::Model)) if number != 0 && may_begin_again => {
                    may_begin_again = false;
                    self.ask(begin, missing)?
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
}

const fn missing(answer: &Answer<'_>) -> Option<Progress> {
    match answer {
        Answer::Install(progress) => Some(*progress),
        _ => None,
    }
}
