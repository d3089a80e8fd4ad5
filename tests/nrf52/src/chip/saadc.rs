//! SAADC, the analogue-to-digital converter (product specification, 6.23): one conversion of one channel, single-ended, of the
//! internal reference by a gain of 1/6.

use std::collections::BTreeMap;

use super::Chip;
use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Register, Registers, clear, event, read_only, read_write, set, task};
use crate::refusal::What;
use crate::time::us;

const START: u32 = 0x000;
const SAMPLE: u32 = 0x004;
const STARTED: u32 = 0x100;
const END: u32 = 0x104;
const STOPPED: u32 = 0x114;
const ENABLE: u32 = 0x500;
const PSELP: u32 = 0x510;
const CONFIG: u32 = 0x518;
const RESOLUTION: u32 = 0x5f0;
const PTR: u32 = 0x62c;
const MAXCNT: u32 = 0x630;
const AMOUNT: u32 = 0x634;
/// Switches the peripheral off and so resets it: a register without a name that Nordic's drivers use.
const POWER: u32 = 0xffc;
const INTERRUPTS: u32 = 0x3f_ffff;
/// CONFIG of a channel: no resistors, gain 1/6, internal reference, 40 us, single-ended (6.23.9).
const EXPECTED: u32 = 5 << 16;
/// The acquisition, and the conversion.
const CONVERSION: u64 = us(42);
/// Input at which all bits are set, millivolts, and values of 12 bits.
const RANGE: u32 = 3600;
const VALUES: u32 = 4096;

/// Inputs of a channel, by their numbers in PSELP.
const INPUTS: [u32; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 13];

const TABLE: &[Register] = &[
    task("TASKS_START", START),
    task("TASKS_SAMPLE", SAMPLE),
    task("TASKS_STOP", 0x008),
    event("EVENTS_STARTED", STARTED),
    event("EVENTS_END", END),
    event("EVENTS_DONE", 0x108),
    event("EVENTS_RESULTDONE", 0x10c),
    event("EVENTS_CALIBRATEDONE", 0x110),
    event("EVENTS_STOPPED", STOPPED),
    set("INTENSET", 0x304, INTEN, INTERRUPTS),
    clear("INTENCLR", 0x308, INTEN, INTERRUPTS),
    read_only("STATUS", 0x400),
    read_write("ENABLE", ENABLE, 1),
    read_write("CH.PSELP", PSELP, 0x1f).times(8).every(16),
    read_write("CH.PSELN", 0x514, 0x1f).times(8).every(16),
    read_write("CH.CONFIG", CONFIG, 0x0117_1733)
        .times(8)
        .every(16)
        .reset(2 << 16),
    read_write("RESOLUTION", RESOLUTION, 7).reset(1),
    read_write("OVERSAMPLE", 0x5f4, 0xf),
    read_write("RESULT.PTR", PTR, !0),
    read_write("RESULT.MAXCNT", MAXCNT, 0x7fff),
    read_only("RESULT.AMOUNT", AMOUNT),
    read_write("POWER", POWER, 1).reset(1),
];

#[derive(Debug)]
pub struct Saadc {
    registers: Registers,
    /// True from a start until the buffer is full.
    is_started: bool,
    /// Tick at which a conversion is done.
    at: Option<u64>,
    /// Millivolts at an input, by its number in PSELP.
    pub inputs: BTreeMap<u32, u32>,
}

impl Saadc {
    /// Creates the converter after a reset, which leaves the inputs as they are.
    pub fn new(inputs: BTreeMap<u32, u32>) -> Self {
        Self {
            registers: Registers::new("SAADC", 0x4000_7000, TABLE),
            is_started: false,
            at: None,
            inputs,
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
        let (address, length) = (self.registers.get(PTR), 2 * self.registers.get(MAXCNT));
        let config = self.registers.get(CONFIG);
        match offset {
            _ if self.registers.get(ENABLE) == 0 => {
                self.untimely(offset, bus, "while it is disabled");
            }
            START if !bus.memory.is_ram(address, length) => {
                self.refuse(PTR, bus, What::NoDma { address, length });
            }
            START if length != 2 => {
                let expected = "one conversion: no other number is modelled";
                self.unexpected(MAXCNT, bus, expected);
            }
            START => {
                self.is_started = true;
                self.raise(STARTED, bus);
            }
            SAMPLE if !self.is_started || self.at.is_some() => {
                let when = match self.at {
                    None => "before it is started",
                    Some(_) => "during a conversion",
                };
                self.untimely(offset, bus, when);
            }
            SAMPLE if !INPUTS.contains(&self.registers.get(PSELP)) => {
                self.unexpected(
                    PSELP,
                    bus,
                    "an input: 1 to 8, 9 for VDD, 13 for VDDH (6.23.9)",
                );
            }
            SAMPLE if config != EXPECTED || self.registers.get(RESOLUTION) != 2 => {
                let expected = "0x50000, with RESOLUTION of 12 bits: no other is modelled";
                self.unexpected(CONFIG, bus, expected);
            }
            SAMPLE => self.at = Some(bus.now + CONVERSION),
            _ => {
                (self.at, self.is_started) = (None, false);
                self.raise(STOPPED, bus);
            }
        }
    }

    fn next(&self) -> Option<u64> {
        self.at
    }

    fn due(&mut self, bus: &mut Bus) {
        (self.at, self.is_started) = (None, false);
        let input = self.inputs.get(&self.registers.get(PSELP));
        let value = input.map_or(0, |millivolts| millivolts * VALUES / RANGE);
        let value = value.min(VALUES - 1) as u16;
        bus.memory
            .write(self.registers.get(PTR), &value.to_le_bytes());
        self.registers.put(AMOUNT, 1);
        self.raise(END, bus);
    }
}

impl Chip {
    /// Puts a voltage at an input of the converter, by its number in PSELP: 1 for AIN0.
    pub fn set_input(&mut self, input: u32, millivolts: u32) {
        self.saadc.inputs.insert(input, millivolts);
    }
}
