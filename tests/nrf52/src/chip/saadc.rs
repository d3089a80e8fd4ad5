//! SAADC, the analogue-to-digital converter (product specification, 6.23): one conversion of one channel, single-ended, of the
//! internal reference by a gain of 1/6.

use std::collections::BTreeMap;

use super::Chip;
use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};
use crate::refusal::What;
use crate::time::us;

const INTERRUPTS: u32 = 0x3f_ffff;
/// CH_CONFIG of a channel: no resistors, gain 1/6, internal reference, 40 us, single-ended (6.23.9).
const EXPECTED: u32 = 5 << 16;
/// The acquisition, and the conversion.
const CONVERSION: u64 = us(42);
/// Input at which all bits are set, millivolts, and values of 12 bits.
const RANGE: u32 = 3600;
const VALUES: u32 = 4096;

/// Inputs of a channel, by their numbers in CH_PSELP.
const INPUTS: [u32; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 13];

registers![
    TASKS_START = task(0x000),
    TASKS_SAMPLE = task(0x004),
    TASKS_STOP = task(0x008),
    EVENTS_STARTED = event(0x100),
    EVENTS_END = event(0x104),
    EVENTS_DONE = event(0x108),
    EVENTS_RESULTDONE = event(0x10c),
    EVENTS_CALIBRATEDONE = event(0x110),
    EVENTS_STOPPED = event(0x114),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    STATUS = read_only(0x400),
    ENABLE = read_write(0x500, 1),
    CH_PSELP = read_write(0x510, 0x1f).times(8).every(16),
    CH_PSELN = read_write(0x514, 0x1f).times(8).every(16),
    CH_CONFIG = read_write(0x518, 0x0117_1733)
        .times(8)
        .every(16)
        .reset(2 << 16),
    RESOLUTION = read_write(0x5f0, 7).reset(1),
    OVERSAMPLE = read_write(0x5f4, 0xf),
    RESULT_PTR = read_write(0x62c, !0),
    RESULT_MAXCNT = read_write(0x630, 0x7fff),
    RESULT_AMOUNT = read_only(0x634),
    // Without a name: it switches the peripheral off and so resets it, which Nordic's drivers do.
    POWER = read_write(0xffc, 1).reset(1),
];

#[derive(Default, Debug)]
pub struct Saadc {
    registers: Registers,
    /// True from a start until the buffer is full.
    is_started: bool,
    /// Tick at which a conversion is done.
    at: Option<u64>,
    /// Millivolts at an input, by its number in CH_PSELP.
    pub inputs: BTreeMap<u32, u32>,
}

impl Saadc {
    pub fn new() -> Self {
        Self {
            registers: Registers::new("SAADC", 0x4000_7000, TABLE),
            ..Self::default()
        }
    }
}

impl Peripheral for Saadc {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        if offset != POWER && self.registers.get(POWER) == 0 {
            self.untimely(offset, bus, "while it is switched off");
        } else if offset == POWER && self.registers.get(POWER) == 0 {
            self.registers = Registers::new("SAADC", 0x4000_7000, TABLE);
            self.registers.put(POWER, 0);
            (self.at, self.is_started) = (None, false);
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let (address, length) = (
            self.registers.get(RESULT_PTR),
            2 * self.registers.get(RESULT_MAXCNT),
        );
        let config = self.registers.get(CH_CONFIG);
        match offset {
            _ if self.registers.get(ENABLE) == 0 => {
                self.untimely(offset, bus, "while it is disabled");
            }
            TASKS_START if !bus.memory.is_ram(address, length) => {
                self.refuse(RESULT_PTR, bus, What::NoDma { address, length });
            }
            TASKS_START if length != 2 => {
                let expected = "one conversion: no other number is modelled";
                self.unexpected(RESULT_MAXCNT, bus, expected);
            }
            TASKS_START => {
                self.is_started = true;
                self.raise(EVENTS_STARTED, bus);
            }
            TASKS_SAMPLE if !self.is_started || self.at.is_some() => {
                let when = match self.at {
                    None => "before it is started",
                    Some(_) => "during a conversion",
                };
                self.untimely(offset, bus, when);
            }
            TASKS_SAMPLE if !INPUTS.contains(&self.registers.get(CH_PSELP)) => {
                self.unexpected(
                    CH_PSELP,
                    bus,
                    "an input: 1 to 8, 9 for VDD, 13 for VDDH (6.23.9)",
                );
            }
            TASKS_SAMPLE if config != EXPECTED || self.registers.get(RESOLUTION) != 2 => {
                let expected = "0x50000, with RESOLUTION of 12 bits: no other is modelled";
                self.unexpected(CH_CONFIG, bus, expected);
            }
            TASKS_SAMPLE => self.at = Some(bus.now + CONVERSION),
            _ => {
                (self.at, self.is_started) = (None, false);
                self.raise(EVENTS_STOPPED, bus);
            }
        }
    }

    fn next(&self) -> Option<u64> {
        self.at
    }

    fn due(&mut self, bus: &mut Bus) {
        (self.at, self.is_started) = (None, false);
        let input = self.inputs.get(&self.registers.get(CH_PSELP));
        let value = input.map_or(0, |millivolts| millivolts * VALUES / RANGE);
        let value = value.min(VALUES - 1) as u16;
        bus.memory
            .write(self.registers.get(RESULT_PTR), &value.to_le_bytes());
        self.registers.put(RESULT_AMOUNT, 1);
        self.raise(EVENTS_END, bus);
    }
}

impl Chip {
    /// Puts a voltage at an input of the converter, by its number in CH_PSELP: 1 for AIN0.
    pub fn set_input(&mut self, input: u32, millivolts: u32) {
        self.saadc.inputs.insert(input, millivolts);
    }
}
