//! TEMP, the temperature sensor (product specification, 6.28): its trimming alone, which start-up code copies from FICR.

use super::bus::{Bus, Peripheral};
use super::register::{Register, Registers, read_write};

const TABLE: &[Register] = &[
    read_write("A", 0x520, 0xfff).times(6),
    read_write("B", 0x540, 0x3fff).times(6),
    read_write("T", 0x560, 0xff).times(5),
];

/// The temperature sensor.
#[derive(Debug)]
pub struct Temp {
    registers: Registers,
}

impl Temp {
    /// After a reset.
    pub fn new() -> Self {
        Self {
            registers: Registers::new("TEMP", TABLE),
        }
    }
}

impl Peripheral for Temp {
    fn base(&self) -> u32 {
        0x4000_c000
    }

    fn registers(&self) -> &Registers {
        &self.registers
    }

    fn registers_mut(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn task(&mut self, _: u32, _: &mut Bus) {}
}
