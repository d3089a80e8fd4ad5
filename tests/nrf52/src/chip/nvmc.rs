//! NVMC, the controller of flash (product specification, 4.3), without the SoftDevice's calls.
//!
//! Writes to UICR and flash need its leave, and halt the core for their time.

use std::collections::BTreeMap;

use super::bus::{Bus, Peripheral, Reset};
use super::register::{Registers, registers};
use crate::memory::ERASED;
use crate::refusal::What;
use crate::time::{ms, us};

/// CONFIG: writing is enabled, erasing is.
const WRITES: u32 = 1;
const ERASES: u32 = 2;
pub const PAGE: u32 = 4096;

registers![
    READY = read_only(0x400).reset(1),
    READYNEXT = read_only(0x408).reset(1),
    CONFIG = read_write(0x504, 3),
    ERASEPAGE = write_only(0x508, !0),
    ERASEPAGEPARTIAL = write_only(0x518, !0),
    ERASEPAGEPARTIALCFG = read_write(0x51c, 0x7f).reset(10),
    ICACHECNF = read_write(0x540, 1 | 1 << 8),
    IHIT = read_write(0x548, !0),
    IMISS = read_write(0x54c, !0),
];

/// Ticks that an operation of flash takes: the longest that the specification gives.
#[derive(Clone, Copy, Debug)]
pub struct FlashTimes {
    pub write: u64,
    pub erase: u64,
}

impl FlashTimes {
    /// nRF52840 (4.3.9).
    pub const NRF52840: Self = Self {
        write: us(41),
        erase: ms(85),
    };
    /// nRF52832 (its product specification, 11.8). It has no partial erasure, which nothing here refuses.
    pub const NRF52832: Self = Self {
        write: us(338),
        erase: us(89_700),
    };
}

#[derive(Debug)]
pub struct Nvmc {
    registers: Registers,
    /// Ticks that an operation of flash takes.
    pub times: FlashTimes,
    bytes: u32,
    /// Pages that are erased in part, with the ticks so far. The silicon remembers: a reset does not end it.
    pub partly_erased: BTreeMap<u32, u64>,
    /// Number of operations after which power fails, in the middle of the next.
    pub power_fails_after: Option<usize>,
}

impl Nvmc {
    pub fn new(times: FlashTimes, bytes: u32) -> Self {
        Self {
            registers: Registers::new("NVMC", 0x4001_e000, TABLE),
            times,
            bytes,
            partly_erased: BTreeMap::new(),
            power_fails_after: None,
        }
    }

    pub fn writes(&self) -> bool {
        self.registers.get(CONFIG) == WRITES
    }

    /// Returns true if neither writing nor erasing is enabled.
    pub fn is_read_only(&self) -> bool {
        self.registers.get(CONFIG) == 0
    }

    pub fn write(&mut self, address: u32, value: u32, bus: &mut Bus) {
        let page = address & !(PAGE - 1);
        let old = bus.memory.word(address).unwrap_or_default();
        if self.partly_erased.contains_key(&page) {
            let expected = "the page is erased in part alone";
            return bus.refuse(address, What::Value { value, expected });
        }
        if old & value != value {
            let expected = "flash holds zeros there: erase first";
            return bus.refuse(address, What::Value { value, expected });
        }
        bus.halt(self.times.write);
        // Half of the bits, if power fails.
        let kept = if self.fails(bus) { 0x5555_5555 } else { 0 };
        bus.memory
            .clear_bits(address, &(value | kept).to_le_bytes());
    }

    /// Counts an operation; true if power fails in its middle.
    fn fails(&mut self, bus: &mut Bus) -> bool {
        let fails = self.power_fails_after == Some(0);
        self.power_fails_after = self.power_fails_after.and_then(|left| left.checked_sub(1));
        if fails {
            bus.reset(Reset::Power);
        }
        fails
    }

    /// Erases a page for `ticks`; it is erased once their sum suffices (4.3.4).
    fn erase(&mut self, page: u32, ticks: u64, bus: &mut Bus) {
        bus.halt(ticks);
        let old = bus.memory.read(page, PAGE).unwrap_or_default();
        let before = self.partly_erased.remove(&page);
        if before.is_none() && old.iter().all(|byte| *byte == ERASED) {
            // It stays erased.
            self.fails(bus);
            return;
        }
        let before = before.unwrap_or_default();
        let ticks = if self.fails(bus) { ticks / 2 } else { ticks };
        if before + ticks >= self.times.erase {
            return bus.memory.erase(page, PAGE as usize);
        }
        // Some bits are ones by now.
        self.partly_erased.insert(page, before + ticks);
        let mixed: Vec<_> = (0_u32..)
            .zip(old)
            .map(|(at, old)| old | (at * 37) as u8)
            .collect();
        bus.memory.program(page, &mixed);
    }
}

impl Peripheral for Nvmc {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        match offset {
            CONFIG if value == 3 => {
                self.unexpected(offset, bus, "0 to read, 1 to write, 2 to erase");
            }
            ERASEPAGE | ERASEPAGEPARTIAL if self.registers.get(CONFIG) != ERASES => {
                self.unexpected(offset, bus, "CONFIG has to enable erasing first");
            }
            ERASEPAGE | ERASEPAGEPARTIAL if !value.is_multiple_of(PAGE) || value >= self.bytes => {
                self.unexpected(offset, bus, "the address of a page");
            }
            ERASEPAGE => self.erase(value, self.times.erase, bus),
            ERASEPAGEPARTIAL => {
                let ticks = ms(self.registers.get(ERASEPAGEPARTIALCFG).into());
                self.erase(value, ticks, bus);
            }
            _ => {}
        }
    }
}
