//! TEMP, the temperature sensor (product specification, 6.28): its trimming alone, which start-up code copies from FICR.

use super::register::{Registers, registers};

registers![
    A = read_write(0x520, 0xfff).times(6),
    B = read_write(0x540, 0x3fff).times(6),
    T = read_write(0x560, 0xff).times(5),
];

/// The sensor after a reset.
pub fn new() -> Registers {
    Registers::new("TEMP", 0x4000_c000, TABLE)
}
