//! NVMC, the controller of flash (product specification, 4.3), without the SoftDevice's calls.
//!
//! Writes to UICR and flash need its leave, and halt the core for their time. Partial erasure is not modelled.

use super::bus::{Bus, Peripheral};
use super::register::{Register, Registers, read_only, read_write, write_only};
use crate::refusal::What;
use crate::time::{ms, us};

const READY: u32 = 0x400;
const READYNEXT: u32 = 0x408;
const CONFIG: u32 = 0x504;
const ERASEPAGE: u32 = 0x508;
const ICACHECNF: u32 = 0x540;
/// CONFIG: writing is enabled, erasing is.
const WRITES: u32 = 1;
const ERASES: u32 = 2;
/// Bytes of a page.
pub const PAGE: u32 = 4096;

const TABLE: &[Register] = &[
    read_only("READY", READY).reset(1),
    read_only("READYNEXT", READYNEXT).reset(1),
    read_write("CONFIG", CONFIG, 3),
    write_only("ERASEPAGE", ERASEPAGE, !0),
    read_write("ICACHECNF", ICACHECNF, 1 | 1 << 8),
    read_write("IHIT", 0x548, !0),
    read_write("IMISS", 0x54c, !0),
];

/// Ticks that an operation of flash takes: the longest that the specification gives.
#[derive(Clone, Copy, Debug)]
pub struct FlashTimes {
    /// A word.
    pub write: u64,
    /// A page.
    pub erase: u64,
}

impl FlashTimes {
    /// nRF52840 (4.3.9).
    pub const NRF52840: Self = Self {
        write: us(41),
        erase: ms(85),
    };
    /// nRF52832 (its product specification, 11.8).
    pub const NRF52832: Self = Self {
        write: us(338),
        erase: us(89_700),
    };
}

/// The controller of flash.
#[derive(Debug)]
pub struct Nvmc {
    registers: Registers,
    /// Ticks that an operation of flash takes.
    pub times: FlashTimes,
    bytes: u32,
}

impl Nvmc {
    /// After a reset.
    pub fn new(times: FlashTimes, bytes: u32) -> Self {
        Self {
            registers: Registers::new("NVMC", TABLE),
            times,
            bytes,
        }
    }

    /// Returns true if writes are enabled.
    pub fn writes(&self) -> bool {
        self.registers.get(CONFIG) == WRITES
    }
}

impl Peripheral for Nvmc {
    fn base(&self) -> u32 {
        0x4001_e000
    }

    fn registers(&self) -> &Registers {
        &self.registers
    }

    fn registers_mut(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        match offset {
            CONFIG if value == 3 => {
                let expected = "0 to read, 1 to write, 2 to erase";
                self.refuse(offset, bus, What::Value { value, expected });
            }
            ERASEPAGE if self.registers.get(CONFIG) != ERASES => {
                let expected = "CONFIG has to enable erasing first";
                self.refuse(offset, bus, What::Value { value, expected });
            }
            ERASEPAGE if !value.is_multiple_of(PAGE) || value >= self.bytes => {
                let expected = "the address of a page";
                self.refuse(offset, bus, What::Value { value, expected });
            }
            ERASEPAGE => {
                bus.memory.erase(value, PAGE as usize);
                bus.halt(self.times.erase);
            }
            _ => {}
        }
    }

    fn task(&mut self, _: u32, _: &mut Bus) {}
}
