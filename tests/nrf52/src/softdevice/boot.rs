//! Contents of flash below the program, where a chip has the master boot record and a SoftDevice: instructions that
//! pass the reset and every exception on to the program, and supervisor calls and hard faults to the emulation.

use crate::memory::Memory;

/// Address that the instructions write to. The emulation takes supervisor calls there.
pub const GATE: u32 = 0x6000_0000;
/// A word for the address of a supervisor call's stacked registers.
pub const CALL: u32 = GATE;
/// A word that is written when a hard fault begins.
pub const HARD_FAULT: u32 = GATE + 4;
/// Bytes of both.
pub const GATE_BYTES: u64 = 8;

/// Address of the SoftDevice's version, major * 1 000 000 + minor * 1000 + bugfix: `SD_VERSION_OFFSET` of `nrf_sdm.h` behind
/// the master boot record.
pub const SOFTDEVICE_VERSION: u32 = 0x1000 + 0x2014;

/// A stack until the program has its own.
const STACK: u32 = 0x2000_0400;
const VECTORS: u32 = 64;

/// Writes instructions that start the program whose vector table begins at `program`, and the vectors that lead to them.
pub fn install_reset(memory: &Memory, program: u32) {
    let reset: [u16; 8] = [
        0x4803, // ldr r0, program
        0x6801, // ldr r1, [r0]
        0xf381, 0x8808, // msr msp, r1
        0x6841, // ldr r1, [r0, #4]
        0x4708, // bx r1
        0xbf00, 0xbf00,
    ];
    halves(memory, 0x200, &reset);
    word(memory, 0x210, program);
    word(memory, 0, STACK);
    word(memory, 4, 0x200 | 1);
}

/// Writes them all into flash, for a program whose vector table begins at `program`.
pub fn install(memory: &Memory, program: u32) {
    install_reset(memory, program);
    let forward: [u16; 6] = [
        0xf3ef, 0x8005, // mrs r0, ipsr
        0x4901, // ldr r1, program
        0xf851, 0x0020, // ldr.w r0, [r1, r0, lsl #2]
        0x4700, // bx r0
    ];
    let call: [u16; 10] = [
        0xf01e, 0x0f04, // tst lr, #4
        0xbf0c, // ite eq
        0xf3ef, 0x8008, // mrseq r0, msp
        0xf3ef, 0x8009, // mrsne r0, psp
        0x4901, // ldr r1, call
        0x6008, // str r0, [r1]
        0x4770, // bx lr
    ];
    let hard_fault: [u16; 4] = [
        0x4901, // ldr r1, hard fault
        0x6009, // str r1, [r1]
        0xe7cc, // b forward
        0xbf00,
    ];
    halves(memory, 0x220, &forward);
    word(memory, 0x22c, program);
    halves(memory, 0x240, &call);
    word(memory, 0x254, CALL);
    halves(memory, 0x280, &hard_fault);
    word(memory, 0x288, HARD_FAULT);
    word(memory, SOFTDEVICE_VERSION, 7_003_000);
    for vector in 2..VECTORS {
        let handler = match vector {
            3 => 0x280,
            11 => 0x240,
            _ => 0x220,
        };
        word(memory, 4 * vector, handler | 1);
    }
}

fn halves(memory: &Memory, address: u32, instructions: &[u16]) {
    let bytes: Vec<u8> = instructions
        .iter()
        .flat_map(|half| half.to_le_bytes())
        .collect();
    memory.program(address, &bytes);
}

fn word(memory: &Memory, address: u32, value: u32) {
    memory.program(address, &value.to_le_bytes());
}
