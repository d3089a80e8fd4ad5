//! FICR, what the factory wrote (product specification, 4.4). It can be read alone.

use super::register::{Registers, registers};

registers![
    CODEPAGESIZE = read_only(0x010),
    CODESIZE = read_only(0x014),
    DEVICEID = read_only(0x060).times(2),
    ER = read_only(0x080).times(4),
    IR = read_only(0x090).times(4),
    DEVICEADDRTYPE = read_only(0x0a0),
    DEVICEADDR = read_only(0x0a4).times(2),
    INFO_PART = read_only(0x100),
    INFO_VARIANT = read_only(0x104),
    INFO_PACKAGE = read_only(0x108),
    INFO_RAM = read_only(0x10c),
    INFO_FLASH = read_only(0x110),
    // Without a name: the workaround of erratum 108 of the nRF52832 copies it.
    ERRATUM108 = read_only(0x258),
    PRODTEST = read_only(0x350).times(3),
    TEMP_A = read_only(0x404).times(6),
    TEMP_B = read_only(0x41c).times(6),
    TEMP_T = read_only(0x434).times(5),
];

pub const BASE: u32 = 0x1000_0000;

/// Creates the FICR of a chip, from its part number, variant, KiB of RAM and KiB of flash.
pub fn of(part: u32, variant: [u8; 4], ram: u32, flash: u32) -> Registers {
    let mut registers = Registers::new("FICR", BASE, TABLE);
    let values = [
        (CODEPAGESIZE, 4096),
        (CODESIZE, flash / 4),
        (DEVICEID, 0x1234_5678),
        (DEVICEID + 4, 0x9abc_def0),
        (DEVICEADDRTYPE, 1),
        (DEVICEADDR, 0xe0b1_c2d3),
        (DEVICEADDR + 4, 0xffff_c0d4),
        (INFO_PART, part),
        (INFO_VARIANT, u32::from_be_bytes(variant)),
        (INFO_PACKAGE, 0x2004),
        (INFO_RAM, ram),
        (ERRATUM108, 0xffff_fff3),
        (INFO_FLASH, flash),
    ];
    for (offset, value) in values {
        registers.put(offset, value);
    }
    registers
}
