//! UICR, configuration that outlives the program (product specification, 4.5). A part of flash: ones become zeros.

use super::register::{Register, Registers, read_write};

const TABLE: &[Register] = &[
    read_write("NRFFW", 0x014, !0).times(15),
    read_write("NRFHW", 0x050, !0).times(12),
    read_write("CUSTOMER", 0x080, !0).times(32),
    read_write("PSELRESET", PSELRESET[0], !0).times(2),
    read_write("APPROTECT", 0x208, !0),
    read_write("NFCPINS", NFCPINS, !0),
    read_write("DEBUGCTRL", 0x210, !0),
    read_write("REGOUT0", REGOUT0, !0),
];

pub const BASE: u32 = 0x1000_1000;
/// Offset of the register that decides if a debugger may access the chip.
pub const APPROTECT: u32 = 0x208;

/// Offsets of the words that name the pin of the reset.
pub const PSELRESET: [u32; 2] = [0x200, 0x204];
/// Offset of the register that gives two pins to NFC.
pub const NFCPINS: u32 = 0x20c;
/// Offset of the register of the levels of all pins, where the supply is at VDDH.
pub const REGOUT0: u32 = 0x304;

pub fn blank() -> Registers {
    let mut registers = Registers::new("UICR", BASE, TABLE);
    for offset in (0..0x400).step_by(4) {
        registers.put(offset, !0);
    }
    registers
}
