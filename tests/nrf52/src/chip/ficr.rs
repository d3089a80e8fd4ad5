//! FICR, what the factory wrote (product specification, 4.4). It can be read alone.

use super::register::{Register, Registers, read_only};

const TABLE: &[Register] = &[
    read_only("CODEPAGESIZE", 0x010),
    read_only("CODESIZE", 0x014),
    read_only("DEVICEID", 0x060).times(2),
    read_only("ER", 0x080).times(4),
    read_only("IR", 0x090).times(4),
    read_only("DEVICEADDRTYPE", 0x0a0),
    read_only("DEVICEADDR", 0x0a4).times(2),
    read_only("INFO.PART", 0x100),
    read_only("INFO.VARIANT", 0x104),
    read_only("INFO.PACKAGE", 0x108),
    read_only("INFO.RAM", 0x10c),
    read_only("INFO.FLASH", 0x110),
    read_only("ERRATUM108", ERRATUM_108),
    read_only("PRODTEST", 0x350).times(3),
    read_only("TEMP.A", 0x404).times(6),
    read_only("TEMP.B", 0x41c).times(6),
    read_only("TEMP.T", 0x434).times(5),
];

/// Offset of the value that the workaround of erratum 108 of the nRF52832 copies: it has no name.
pub const ERRATUM_108: u32 = 0x258;

pub const BASE: u32 = 0x1000_0000;

/// Creates the FICR of a chip, from its part number, variant, KiB of RAM and KiB of flash.
pub fn of(part: u32, variant: [u8; 4], ram: u32, flash: u32) -> Registers {
    let mut registers = Registers::new("FICR", BASE, TABLE);
    let values = [
        (0x010, 4096),
        (0x014, flash / 4),
        (0x060, 0x1234_5678),
        (0x064, 0x9abc_def0),
        (0x0a0, 1),
        (0x0a4, 0xe0b1_c2d3),
        (0x0a8, 0xffff_c0d4),
        (0x100, part),
        (0x104, u32::from_be_bytes(variant)),
        (0x108, 0x2004),
        (0x10c, ram),
        (ERRATUM_108, 0xffff_fff3),
        (0x110, flash),
    ];
    for (offset, value) in values {
        registers.put(offset, value);
    }
    registers
}
