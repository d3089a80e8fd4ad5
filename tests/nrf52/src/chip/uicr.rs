//! UICR, configuration that outlives the program (product specification, 4.5). A part of flash: ones become zeros.

use super::register::{Registers, registers};

registers![
    NRFFW = read_write(0x014, !0).times(15),
    NRFHW = read_write(0x050, !0).times(12),
    CUSTOMER = read_write(0x080, !0).times(32),
    PSELRESET = read_write(0x200, !0).times(2),
    APPROTECT = read_write(0x208, !0),
    NFCPINS = read_write(0x20c, !0),
    DEBUGCTRL = read_write(0x210, !0),
    REGOUT0 = read_write(0x304, !0),
];

pub const BASE: u32 = 0x1000_1000;
/// Offsets of the words that name the pin of the reset.
pub const RESET_PINS: [u32; 2] = [PSELRESET, PSELRESET + 4];

pub fn blank() -> Registers {
    let mut registers = Registers::new("UICR", BASE, TABLE);
    for offset in (0..0x400).step_by(4) {
        registers.put(offset, !0);
    }
    registers
}
