//! Installation of a model on a board, without I/O: sends the blocks that the board asks for, and continues after a break.

use serde::{Serialize, Serializer};
use shared::installation::{BLOCK_BYTES, Block, InstallationProgress, PAGE_BYTES, Transfer};
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;
use shared::uart_line::line::Line;
use shared::uf2::MODEL_REGION;
use shared::units::Millis;

use crate::said::{Said, as_text};

/// Longest time to wait for an answer in ms. A board answers within a second, after the lines already queued for the UART.
const ANSWER_MS: u32 = 2_000;
/// Number of times a command is sent before the board counts as silent.
const ATTEMPTS: u32 = 3;
/// Time without progress after which a lost board is given up.
const PATIENCE_MS: u32 = 30_000;
/// Begins without progress after which a board is given up: it restarts each time.
const MOST_BEGINS: u32 = 10;
/// Blocks without progress after which a board is given up. After a begin, the first block and those of one page are sent
/// again.
const MOST_BLOCKS: u32 = MOST_BEGINS * (1 + (PAGE_BYTES / BLOCK_BYTES) as u32);
/// Number of times a board may report a finished installation while it runs another model: late answers to other blocks.
const MOST_DOUBTS: u32 = 3;

/// Error of an installation.
#[derive(Clone, PartialEq, Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
pub enum InstallError {
    /// No answer came.
    #[error("no answer: is the board powered, and does no other program read its port?")]
    Silent,
    /// The board refuses.
    #[error("the board refuses: {why}")]
    Refused {
        /// Refusal in the words of the line.
        #[serde(serialize_with = "refusal")]
        why: Refusal,
    },
    /// The board cannot run the model.
    #[error("the board cannot run this model, and is safe; it says: {reason}")]
    Model {
        /// Reason in the board's own words.
        reason: String,
    },
    /// There is no progress.
    #[error(
        "the board gets no further than block {furthest} of {of}, begun {begins} times: it restarts, or asks for the same blocks again and again; check its power supply"
    )]
    NoProgress {
        /// Greatest number of blocks that the board had.
        furthest: u32,
        /// Number of blocks in the file.
        of: u32,
        /// Number of times the installation was begun without progress.
        begins: u32,
    },
    /// The board says that the model is installed, but runs another one.
    #[error(
        "the board says that all is installed, but runs model {found}, expected {expected}: close every other program that uses the port"
    )]
    OtherModel {
        /// CRC-32 of the file.
        expected: String,
        /// CRC-32 of the board's model.
        found: String,
    },
    /// The board says that the model is installed, but runs none.
    #[error(
        "the board says that all is installed, but runs none, expected {expected}: close every other program that uses the port"
    )]
    NoModel {
        /// CRC-32 of the file.
        expected: String,
    },
    /// The file is not a model file, or no board has room for the model.
    #[error("no board can run this file, and nothing was sent: {reason}")]
    Unfit {
        /// Error of the file.
        #[from]
        #[serde(serialize_with = "as_text")]
        reason: ModelError,
    },
    /// The file is longer than a board's flash region.
    #[error(
        "{length} bytes, a board has room for {room}, and nothing was sent: train a smaller model"
    )]
    Long {
        /// Length of the file in bytes.
        length: usize,
        /// Length of the region in bytes.
        room: usize,
    },
}

impl InstallError {
    /// Whether another installation goes on where this one ended.
    pub const fn goes_on(&self) -> bool {
        !matches!(
            self,
            Self::Model { .. } | Self::Unfit { .. } | Self::Long { .. }
        )
    }
}

fn refusal<S: Serializer>(why: &Refusal, output: S) -> Result<S::Ok, S::Error> {
    Said::of("refusal", why).serialize(output)
}

/// Whether a board asks for the line again: it was damaged on the way, or comes too early.
#[must_use]
pub const fn asks_again(refusal: Refusal) -> bool {
    matches!(
        refusal,
        Refusal::Checksum(_)
            | Refusal::Frame
            | Refusal::TooLong
            | Refusal::Block
            | Refusal::Flash
            | Refusal::Busy
    )
}

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
    pub fn new(bytes: &'f [u8]) -> Result<Self, InstallError> {
        let model = Model::parse(bytes)?;
        DeviceEncoder::new(&model)?;
        let bytes = &bytes[..model.length];
        match u32::try_from(bytes.len()) {
            Ok(length) if bytes.len() <= MODEL_REGION.len() => Ok(Self {
                bytes,
                transfer: Transfer {
                    length,
                    checksum: model.checksum,
                },
            }),
            _ => Err(InstallError::Long {
                length: bytes.len(),
                room: MODEL_REGION.len(),
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

/// Question to the board.
#[derive(Clone, Copy, Debug)]
enum Question {
    Begin,
    Block(u32),
    /// Which model it runs, once it has said that all is installed.
    Identity,
}

/// Installation in progress. It succeeds once the board reports that it runs the model.
#[derive(Debug)]
pub struct Installer {
    file: Vec<u8>,
    transfer: Transfer,
    question: Question,
    /// Number of times that the question was sent, and the last time; none if it is due now.
    attempts: u32,
    sent: Option<Millis>,
    refused: Option<Refusal>,
    /// Reason why the board has refused a model, in its own words.
    reason: Option<String>,
    may_begin_again: bool,
    doubts: u32,
    budget: Budget,
    end: Option<Result<(), InstallError>>,
}

/// Questions since the board last made progress.
#[derive(Debug)]
struct Budget {
    /// Greatest number of blocks that the board had; none before its first answer.
    furthest: Option<u32>,
    since: Millis,
    begins: u32,
    blocks: u32,
}

impl Budget {
    const fn new(now: Millis, furthest: Option<u32>) -> Self {
        Self {
            furthest,
            since: now,
            begins: 0,
            blocks: 0,
        }
    }
}

impl Installer {
    /// Begins an installation.
    #[must_use]
    pub fn new(file: ModelFile<'_>, now: Millis) -> Self {
        let mut installer = Self {
            file: file.bytes.to_vec(),
            transfer: file.transfer,
            question: Question::Begin,
            attempts: 0,
            sent: None,
            refused: None,
            reason: None,
            may_begin_again: true,
            doubts: 0,
            budget: Budget::new(now, None),
            end: None,
        };
        installer.begin();
        installer
    }

    /// Number of blocks that the board has; none before its first answer.
    #[must_use]
    pub const fn blocks(&self) -> Option<u32> {
        self.budget.furthest
    }

    /// Number of blocks of the file.
    #[must_use]
    pub const fn of(&self) -> u32 {
        self.transfer.blocks()
    }

    /// CRC-32 of the file.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        self.transfer.checksum
    }

    /// The file that is installed.
    #[must_use]
    pub fn file(&self) -> &[u8] {
        &self.file
    }

    /// How the installation has ended; none while it goes on. A new one continues where a failed one ended.
    #[must_use]
    pub const fn end(&self) -> Option<&Result<(), InstallError>> {
        self.end.as_ref()
    }

    /// Begins again with a board that was lost. Returns false if it is given up.
    pub fn resume(&mut self, now: Millis) -> bool {
        let goes_on = self.budget.furthest.is_some() && !self.is_late(now);
        if goes_on {
            (self.may_begin_again, self.doubts) = (true, 0);
            self.begin();
        }
        goes_on
    }

    /// Continues on a new connection.
    pub fn connected(&mut self, now: Millis) {
        self.wait(now);
        if self.end.is_none() && !self.resume(now) {
            // The board that was waited for.
            self.ask(Question::Begin);
        }
    }

    /// Lets time pass without a connection.
    pub fn wait(&mut self, now: Millis) {
        if self.end.is_none() && self.budget.furthest.is_some() && self.is_late(now) {
            self.fail(InstallError::Silent);
        }
    }

    fn is_late(&self, now: Millis) -> bool {
        now.elapsed_since(self.budget.since) > PATIENCE_MS
    }

    /// Returns the command that is due.
    pub fn command(&mut self, now: Millis) -> Option<Command> {
        let waits = |sent| now.elapsed_since(sent) < ANSWER_MS;
        if self.end.is_some() || self.sent.is_some_and(waits) {
            return None;
        }
        if self.attempts == ATTEMPTS {
            if let Some(refusal) = self.refused {
                self.fail(InstallError::Refused { why: refusal });
                return None;
            }
            if !self.resume(now) {
                self.fail(InstallError::Silent);
                return None;
            }
        }
        if self.end.is_some() {
            return None;
        }
        self.attempts += 1;
        self.sent = Some(now);
        Some(self.question())
    }

    /// Takes a line of the board. A damaged one has none: its command is sent again.
    pub fn line(&mut self, now: Millis, line: &Line<'_>) {
        match line {
            Line::Comment(text) if text.starts_with(" model refused: ") => {
                self.reason = Some(text.trim().to_owned());
            }
            // Answers to other commands are late, or caused by another program.
            Line::Answer(answer)
                if self.attempts > 0 && self.end.is_none() && answer.answers(self.question()) =>
            {
                self.answer(now, answer);
            }
            _ => {}
        }
    }

    fn question(&self) -> Command {
        match self.question {
            Question::Begin => Command::Install(self.transfer),
            Question::Block(number) => Command::Block(number, Block::of(&self.file, number)),
            Question::Identity => Command::Identify,
        }
    }

    fn answer(&mut self, now: Millis, answer: &Answer<'_>) {
        match (self.question, answer) {
            (_, Answer::Refused(refusal)) if asks_again(*refusal) => {
                self.refused = Some(*refusal);
                self.sent = None;
            }
            // The board has restarted.
            (Question::Block(_), Answer::Refused(Refusal::NotBegun)) => self.begin(),
            // The old content of its flash does not match its journal.
            (Question::Block(number), Answer::Refused(Refusal::Model))
                if number != 0 && self.may_begin_again =>
            {
                self.may_begin_again = false;
                self.begin();
            }
            (Question::Block(_), Answer::Refused(Refusal::Model)) => {
                let reason = self.reason.take();
                let reason = reason.unwrap_or_else(|| "nothing".to_owned());
                self.fail(InstallError::Model { reason });
            }
            (_, Answer::Refused(refusal)) => self.fail(InstallError::Refused { why: *refusal }),
            (_, Answer::Install(InstallationProgress::Installed)) => self.ask(Question::Identity),
            // A board never asks for the block that it has just taken: this answers an earlier line.
            (Question::Block(sent), Answer::Install(InstallationProgress::Next(number)))
                if *number == sent => {}
            (_, Answer::Install(InstallationProgress::Next(number))) => self.next(now, *number),
            (_, Answer::Identity(identity)) => self.identified(identity.model),
            _ => {}
        }
    }

    fn next(&mut self, now: Millis, number: u32) {
        // A board never asks for a block past the end. If one did, it would refuse the block sent here.
        let before = self.transfer.before(number.min(self.of()));
        if self
            .budget
            .furthest
            .is_none_or(|furthest| before > furthest)
        {
            self.budget = Budget::new(now, Some(before));
        }
        self.budget.blocks += 1;
        self.ask(Question::Block(number));
    }

    fn identified(&mut self, found: Option<u32>) {
        let expected = self.transfer.checksum;
        if found == Some(expected) {
            self.budget.furthest = Some(self.of());
            self.end = Some(Ok(()));
            return;
        }
        // The answer belonged to another program's block, or was late.
        self.doubts += 1;
        if self.doubts > MOST_DOUBTS {
            let expected = format!("{expected:08x}");
            self.fail(match found {
                Some(found) => InstallError::OtherModel {
                    expected,
                    found: format!("{found:08x}"),
                },
                None => InstallError::NoModel { expected },
            });
        } else {
            self.begin();
        }
    }

    /// Begins or continues on the board.
    fn begin(&mut self) {
        self.budget.begins += 1;
        self.ask(Question::Begin);
    }

    fn ask(&mut self, question: Question) {
        (self.question, self.attempts, self.sent, self.refused) = (question, 0, None, None);
        let Budget {
            furthest,
            begins,
            blocks,
            ..
        } = self.budget;
        if begins > MOST_BEGINS || blocks > MOST_BLOCKS {
            self.fail(InstallError::NoProgress {
                furthest: furthest.unwrap_or(0),
                of: self.of(),
                begins,
            });
        }
    }

    fn fail(&mut self, error: InstallError) {
        self.end = Some(Err(error));
    }
}

#[cfg(test)]
pub(crate) mod tests;
