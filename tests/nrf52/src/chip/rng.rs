//! RNG, random numbers (product specification, 6.21); here the same ones in every run.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};
use crate::time::us;

/// A byte with bias correction (6.21.3).
const BYTE: u64 = us(120);

registers![
    TASKS_START = task(0x000),
    TASKS_STOP = task(0x004),
    EVENTS_VALRDY = event(0x100),
    SHORTS = read_write(0x200, 1),
    INTENSET = set(0x304, INTEN, 1),
    INTENCLR = clear(0x308, INTEN, 1),
    CONFIG = read_write(0x504, 1),
    VALUE = read_only(0x508),
];

#[derive(Debug)]
pub struct Rng {
    registers: Registers,
    state: u32,
    at: Option<u64>,
}

impl Rng {
    pub fn new() -> Self {
        Self {
            registers: Registers::new("RNG", 0x4000_d000, TABLE),
            state: 0x2545_f491,
            at: None,
        }
    }
}

impl Peripheral for Rng {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        self.at = (offset == TASKS_START).then_some(bus.now + BYTE);
    }

    fn next(&self) -> Option<u64> {
        self.at
    }

    fn due(&mut self, bus: &mut Bus) {
        self.state = self
            .state
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        self.registers.put(VALUE, self.state >> 24);
        let stops = self.registers.get(SHORTS) & 1 == 1;
        self.at = (!stops).then_some(bus.now + BYTE);
        self.raise(EVENTS_VALRDY, bus);
    }
}
