//! Flash calls (`nrf_soc.h`): one operation at a time, an event when it has ended. The core stands still meanwhile.

use std::collections::VecDeque;

use super::SoftDevice;
use super::calls::{answer, event};
use crate::chip::{Chip, PAGE, Reset};
use crate::memory::take;
use crate::refusal::{What, needs};

/// Words of the longest write.
const MOST_WORDS: u32 = PAGE / 4;

/// Effect of an operation.
#[derive(Clone, Debug)]
enum Change {
    Erase { page: u32 },
    Write { address: u32, bytes: Vec<u8> },
}

/// Outcome that a test gives to an operation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fate {
    /// It succeeds.
    Success,
    /// No time is found beside the radio: the event of an error, and flash as it was.
    TimeOut,
    /// Power fails in the middle of the operation.
    PowerCut {
        /// Part that is done by then, 0 to 100.
        percent: u32,
    },
}

/// Operations of flash.
#[derive(Debug, Default)]
pub struct Flash {
    under_way: Option<(u64, Change, Fate)>,
    /// Outcomes of the next operations. Those after them succeed.
    pub fates: VecDeque<Fate>,
    /// Number of operations that have begun.
    pub begun: usize,
    /// True if an erasure finds no time while the radio is in use.
    pub needs_silence: bool,
}

impl Flash {
    pub fn reset(&mut self) {
        self.under_way = None;
    }

    /// Returns the tick at which the operation under way ends, if there is one.
    pub fn next(&self) -> Option<u64> {
        self.under_way.as_ref().map(|(at, ..)| *at)
    }
}

impl SoftDevice {
    pub(super) fn erase(&mut self, page: u32, chip: &mut Chip) -> Result<u32, What> {
        if self.flash.under_way.is_some() {
            return Ok(answer::BUSY);
        }
        let pages = self.kind.program() / PAGE..chip.model.flash() / PAGE;
        needs(
            pages.contains(&page),
            "for a page that is not the program's",
        )?;
        let ticks = chip.nvmc.times.erase;
        Ok(self.begin(Change::Erase { page }, ticks, chip))
    }

    /// Writes words.
    pub(super) fn write(
        &mut self,
        [address, source, words, _]: [u32; 4],
        chip: &mut Chip,
    ) -> Result<u32, What> {
        if self.flash.under_way.is_some() {
            return Ok(answer::BUSY);
        }
        let is_aligned = address.is_multiple_of(4) && source.is_multiple_of(4);
        needs(is_aligned, "with an address that is no multiple of four")?;
        let is_allowed = (1..=MOST_WORDS).contains(&words) && address >= self.kind.program();
        needs(
            is_allowed,
            "for none or too many words, or below the program",
        )?;
        // It is read while the operation is under way, when flash cannot be.
        let is_ram = chip.bus.memory.is_ram(source, 4 * words);
        needs(is_ram, "with a source of words that is no RAM")?;
        let bytes = take(&chip.bus.memory, source, 4 * words)?;
        let old = take(&chip.bus.memory, address, 4 * words)?;
        let mut both = old.iter().zip(&bytes);
        needs(
            both.all(|(old, new)| old & new == *new),
            "to write ones where flash holds zeros: erase first",
        )?;
        let ticks = chip.nvmc.times.write * u64::from(words);
        Ok(self.begin(Change::Write { address, bytes }, ticks, chip))
    }

    fn begin(&mut self, change: Change, ticks: u64, chip: &mut Chip) -> u32 {
        let is_erasure = matches!(change, Change::Erase { .. });
        let fate = if is_erasure && self.flash.needs_silence && self.air.is_in_use() {
            Fate::TimeOut
        } else {
            self.flash.fates.pop_front().unwrap_or(Fate::Success)
        };
        self.flash.begun += 1;
        if fate != Fate::TimeOut {
            chip.bus.halt(ticks);
        }
        self.flash.under_way = Some((chip.bus.now + ticks, change, fate));
        answer::SUCCESS
    }

    /// Ends the operation that is due.
    pub(super) fn finish_flash(&mut self, chip: &mut Chip) {
        let due = |(at, ..): &mut (u64, Change, Fate)| *at <= chip.bus.now;
        let Some((_, change, fate)) = self.flash.under_way.take_if(due) else {
            return;
        };
        let part = |bytes: usize| match fate {
            Fate::Success => bytes,
            Fate::TimeOut => 0,
            Fate::PowerCut { percent } => bytes * percent as usize / 100,
        };
        match change {
            Change::Erase { page } => chip.bus.memory.erase(page * PAGE, part(PAGE as usize)),
            Change::Write { address, bytes } => {
                // Words are written one after the other.
                let done = part(bytes.len()) / 4 * 4;
                chip.bus.memory.clear_bits(address, &bytes[..done]);
            }
        }
        match fate {
            Fate::PowerCut { .. } => chip.bus.reset(Reset::Power),
            Fate::TimeOut => self.push_chip_event(event::FLASH_ERROR),
            Fate::Success => self.push_chip_event(event::FLASH_SUCCESS),
        }
    }
}
