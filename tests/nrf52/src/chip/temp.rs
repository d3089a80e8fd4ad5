//! TEMP, the temperature sensor (product specification, 6.28): its trimming alone, which start-up code copies from FICR.

use super::register::{Register, Registers, read_write};

const TABLE: &[Register] = &[
    read_write("A", 0x520, 0xfff).times(6),
    read_write("B", 0x540, 0x3fff).times(6),
    read_write("T", 0x560, 0xff).times(5),
];

/// The sensor after a reset.
pub fn new() -> Registers {
    Registers::new("TEMP", 0x4000_c000, TABLE)
}
