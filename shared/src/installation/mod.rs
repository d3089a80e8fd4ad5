//! A new model in place of the one in flash: which block comes next, and what is done with flash for it. No I/O.
//!
//! A file is exchanged in blocks of 64 bytes. The receiver says which one it wants, so a sender knows the file and nothing
//! else, and may be another one after a break. Flash is written in this order, so that at every moment its content is the
//! old model, no model, or the new one:
//!
//! 1. The first block is looked at: it says whether the file is one for this program. It is kept in memory.
//! 2. The [`journal`], a page of its own, says which file comes. The first page of the region is erased: from here on there
//!    is no model.
//! 3. Page by page from the second on: erased, written, marked in the journal.
//! 4. The first page without its first block.
//! 5. The first block. The whole region is read as at a start.
//!
//! After a loss of power the journal says which pages hold their part of which file; the page that was being written is
//! written again.
//!
//! ```text
//! begin(transfer) or take(block) -> step(), done(), step(), done(), ... none -> progress()
//! ```
//!
//! The caller carries out the steps, in this order, and says what came of each. Any blocks may come in any order: one that
//! was not asked for changes nothing. A step that fails leaves the block to be asked for again. Where it fails before flash has
//! lost the old model, that is put back in use.

pub mod journal;
#[cfg(any(test, feature = "write"))]
mod simulated_flash;
#[cfg(test)]
mod tests;
mod transfer;

use self::journal::Journal;
#[cfg(any(test, feature = "write"))]
pub use self::simulated_flash::SimulatedFlash;
use self::transfer::PAGE_BLOCKS;
pub use self::transfer::{BLOCK_BYTES, Block, PAGE_BYTES, Transfer};

/// Step of an installation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum InstallationStep {
    /// Enter the safe state, and read the region no more.
    Suspend,
    /// Erase the journal.
    EraseJournal,
    /// Write its record, [`Installation::record`].
    WriteJournal,
    /// Erase this page of the region.
    ErasePage(u32),
    /// Write [`Installation::content`] to this block of the region.
    WriteBlock(u32),
    /// Write the mark of this page to the journal.
    MarkPage(u32),
    /// Read the region as at a start. That it holds no model is a failure.
    Verify,
    /// Erase the journal: the file is whole, or there is no use in going on with it.
    EndJournal,
    /// Put the region's model in use: the new one, or the old one after a failure that left it whole.
    Resume,
}

// Steps of a kind: bits of what is to be done, in order.
const SUSPEND: u16 = 1 << 0;
const ERASE_JOURNAL: u16 = 1 << 1;
const WRITE_JOURNAL: u16 = 1 << 2;
const ERASE_PAGE: u16 = 1 << 3;
const WRITE_BLOCK: u16 = 1 << 4;
const MARK_PAGE: u16 = 1 << 5;
const WRITE_FIRST: u16 = 1 << 6;
const VERIFY: u16 = 1 << 7;
const END_JOURNAL: u16 = 1 << 8;
const RESUME: u16 = 1 << 9;

/// Steps of the first block. After a failure of one of them the region may still hold the old model.
const LOSES_MODEL: u16 = SUSPEND | ERASE_JOURNAL | WRITE_JOURNAL | ERASE_PAGE;

/// Progress of an installation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum InstallationProgress {
    /// Number of the next missing block.
    Next(u32),
    /// The model is in use.
    Installed,
}

/// Reason for which nothing was done.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Refused {
    /// The file is longer than the region, or too short to be one.
    Length,
    /// No transfer was begun, or it is over.
    NotBegun,
    /// The file has no such block.
    NoSuchBlock,
    /// The inference did not do its part in time.
    Busy,
    /// Flash was not erased or written.
    Flash,
    /// The region holds no model now.
    Model,
}

/// The receiver of a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Installation {
    /// Bytes of the region.
    capacity: u32,
    transfer: Option<Transfer>,
    /// Blocks that are not missing, in the order in which they are asked for.
    taken: u32,
    /// Pages that the journal says are written, from the second on; `None` if the journal is of another transfer.
    marked: Option<u32>,
    /// The steps that are left for the newest block.
    pending: u16,
    /// The newest block, and its number.
    block: Block,
    number: u32,
    /// The file's first block.
    first: Block,
    /// The whole region was read, and holds no model.
    is_bad: bool,
    /// The failure after which the old model is put back in use.
    failed: Option<Refused>,
}

impl Installation {
    /// An installation that has not begun. `capacity` is the length of the region in bytes.
    #[must_use]
    pub const fn new(capacity: u32) -> Self {
        Self {
            capacity,
            transfer: None,
            taken: 0,
            marked: None,
            pending: 0,
            block: Block::ERASED,
            number: 0,
            first: Block::ERASED,
            is_bad: false,
            failed: None,
        }
    }

    /// Begins a transfer, or continues it. `journal` is what the journal says; none while a model is in use, for then it
    /// means nothing. Asks for nothing to be done.
    pub fn begin(
        &mut self,
        transfer: Transfer,
        journal: Option<Journal>,
    ) -> Result<InstallationProgress, Refused> {
        if transfer.length > self.capacity || transfer.blocks() < 2 {
            return Err(Refused::Length);
        }
        if self.transfer != Some(transfer) {
            let journal = journal.filter(|journal| journal.transfer == transfer);
            *self = Self {
                transfer: Some(transfer),
                marked: journal.map(|journal| journal.marked),
                ..Self::new(self.capacity)
            };
        }
        Ok(self.progress())
    }

    /// Takes a block; [`Installation::step`] says what is to be done with it. One that was not asked for changes nothing.
    /// `is_ours` looks at the file's first block, and says whether the file is one for this program.
    pub fn take(
        &mut self,
        number: u32,
        block: &Block,
        is_ours: impl FnOnce(&Block) -> bool,
    ) -> Result<(), Refused> {
        self.pending = 0;
        self.failed = None;
        let transfer = self.transfer.ok_or(Refused::NotBegun)?;
        if number >= transfer.blocks() {
            return Err(Refused::NoSuchBlock);
        }
        if number != transfer.block(self.taken) {
            return Ok(());
        }
        self.block = *block;
        self.number = number;
        if number == 0 {
            if !is_ours(block) {
                self.transfer = None;
                return Err(Refused::Model);
            }
            self.pending = match self.marked {
                Some(_) => SUSPEND,
                None => SUSPEND | ERASE_JOURNAL | WRITE_JOURNAL | ERASE_PAGE,
            };
            return Ok(());
        }
        self.pending = WRITE_BLOCK;
        let is_last = number + 1 == transfer.blocks();
        if number == 1 || number.is_multiple_of(PAGE_BLOCKS) {
            self.pending |= ERASE_PAGE;
        }
        if number >= PAGE_BLOCKS && (is_last || (number + 1).is_multiple_of(PAGE_BLOCKS)) {
            self.pending |= MARK_PAGE;
        }
        if self.taken + 1 == transfer.blocks() {
            self.pending |= WRITE_FIRST | VERIFY | END_JOURNAL | RESUME;
        }
        Ok(())
    }

    /// The next step; none once everything is done.
    #[must_use]
    pub const fn step(&self) -> Option<InstallationStep> {
        let page = self.number / PAGE_BLOCKS;
        Some(match self.lowest() {
            0 => return None,
            SUSPEND => InstallationStep::Suspend,
            ERASE_JOURNAL => InstallationStep::EraseJournal,
            WRITE_JOURNAL => InstallationStep::WriteJournal,
            ERASE_PAGE => InstallationStep::ErasePage(page),
            WRITE_BLOCK => InstallationStep::WriteBlock(self.number),
            MARK_PAGE => InstallationStep::MarkPage(page),
            WRITE_FIRST => InstallationStep::WriteBlock(0),
            VERIFY => InstallationStep::Verify,
            END_JOURNAL => InstallationStep::EndJournal,
            _ => InstallationStep::Resume,
        })
    }

    /// The block that [`InstallationStep::WriteBlock`] writes.
    #[must_use]
    pub const fn content(&self) -> &Block {
        match self.lowest() {
            WRITE_FIRST => &self.first,
            _ => &self.block,
        }
    }

    /// The record that [`InstallationStep::WriteJournal`] writes.
    #[must_use]
    pub fn record(&self) -> journal::Record {
        journal::to_record(self.transfer.unwrap_or_default())
    }

    /// Takes the outcome of the step. After a failure the block is missing still. No other step is left, but at the first
    /// block: there [`InstallationStep::Resume`] puts the old model back in use if the region still holds it, and the failure is
    /// returned after that step.
    ///
    /// # Errors
    /// The failure; [`Refused::Model`] where the region holds no model, with which the transfer is over.
    pub const fn done(&mut self, outcome: Result<(), Refused>) -> Result<(), Refused> {
        let step = self.lowest();
        self.pending &= !step;
        if let Some(failed) = self.failed.take() {
            return Err(failed);
        }
        match (step, outcome) {
            (VERIFY, Err(Refused::Model)) => {
                self.is_bad = true;
                self.pending = END_JOURNAL;
            }
            // The model is whole, whatever the journal says; without one it is of no use.
            (END_JOURNAL, _) if !self.is_bad => {}
            (END_JOURNAL, _) | (RESUME, Err(Refused::Model)) => {
                *self = Self::new(self.capacity);
                return Err(Refused::Model);
            }
            (_, Err(refused)) if self.number == 0 && step & LOSES_MODEL != 0 => {
                self.failed = Some(refused);
                self.pending = RESUME;
                return Ok(());
            }
            (_, Err(refused)) => {
                self.pending = 0;
                return Err(refused);
            }
            (_, Ok(())) => {}
        }
        if step != 0 && self.pending == 0 {
            self.block_is_done();
        }
        Ok(())
    }

    const fn block_is_done(&mut self) {
        let Some(transfer) = self.transfer else {
            return;
        };
        self.taken += 1;
        if self.number == 0 {
            self.first = self.block;
            // Pages that are written already are not asked for.
            let marked = match self.marked {
                Some(marked) => marked.saturating_mul(PAGE_BLOCKS),
                None => 0,
            };
            let later = transfer.later();
            self.taken += if marked < later { marked } else { later };
            self.marked = Some(0);
        }
        if self.taken >= transfer.blocks() {
            *self = Self::new(self.capacity);
        }
    }

    /// Block that is missing; installed if no transfer is in progress.
    #[must_use]
    pub const fn progress(&self) -> InstallationProgress {
        match self.transfer {
            Some(transfer) => InstallationProgress::Next(transfer.block(self.taken)),
            None => InstallationProgress::Installed,
        }
    }

    /// The lowest bit of what is left.
    const fn lowest(&self) -> u16 {
        self.pending & self.pending.wrapping_neg()
    }
}
