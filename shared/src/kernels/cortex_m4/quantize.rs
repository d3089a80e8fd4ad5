//! Largest magnitude and rounding of floats.

use core::arch::naked_asm;

use crate::arithmetic::ROUNDING;

/// Four values for [`absmax_bits`].
macro_rules! four_magnitudes {
    () => {
        "ldmia r0!, {{r3, r4, r5, r6}}
         cmp r2, r3, lsl #1
         it lo
         lsllo r2, r3, #1
         cmp r2, r4, lsl #1
         it lo
         lsllo r2, r4, #1
         cmp r2, r5, lsl #1
         it lo
         lsllo r2, r5, #1
         cmp r2, r6, lsl #1
         it lo
         lsllo r2, r6, #1"
    };
}

/// The bits of the largest magnitude. Bit patterns are ordered as the magnitudes, and NaN above all.
///
/// Registers: r2 the largest so far, shifted left by one bit to drop the sign.
///
/// # Safety
/// The values up to `end` are readable, a multiple of four, not 0.
// SAFETY: the body is a whole function of the C calling convention: it takes its arguments from r0 to
// r3 and the stack, keeps r4 to r11 and the stack pointer, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn absmax_bits(values: *const f32, end: *const f32) -> u32 {
    naked_asm!(
        "push {{r4, r5, r6}}",
        "movs r2, #0",
        "subs r3, r1, r0",
        "lsls r3, r3, #27",
        "bpl 1f",
        four_magnitudes!(),
        "cmp r0, r1",
        "beq 2f",
        "1:",
        four_magnitudes!(),
        four_magnitudes!(),
        "cmp r0, r1",
        "bne 1b",
        "2:",
        "lsrs r0, r2, #1",
        "pop {{r4, r5, r6}}",
        "bx lr",
    )
}

/// Four codes for [`round_to_codes`].
macro_rules! four_codes {
    () => {
        "vldmia r0!, {{s4, s5, s6, s7}}
         vmul.f32 s4, s4, s0
         vmul.f32 s5, s5, s0
         vmul.f32 s6, s6, s0
         vmul.f32 s7, s7, s0
         vadd.f32 s4, s4, s1
         vadd.f32 s5, s5, s1
         vadd.f32 s6, s6, s1
         vadd.f32 s7, s7, s1
         vmov r3, r12, s4, s5
         pkhbt r3, r3, r12, lsl #16
         str r3, [r2], #4
         vmov r3, r12, s6, s7
         pkhbt r3, r3, r12, lsl #16
         str r3, [r2], #4"
    };
}

/// `codes[i] = values[i] * factor`, rounded to the nearest, halves to even.
///
/// By adding 1.5 x 2^23, as [`round_to_even`](crate::arithmetic::round_to_even) does: the code is
/// the low half of the sum, and two codes make a word.
///
/// # Safety
/// The values up to `end` are readable, a multiple of four, not 0; as many codes are writable, at a
/// multiple of four bytes.
// SAFETY: the body is a whole function of the C calling convention with float arguments in registers,
// which every `eabihf` target has: it takes `factor` from s0 and the others from r0 to r2, changes only
// registers that a function may change, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn round_to_codes(
    values: *const f32,
    end: *const f32,
    codes: *mut i16,
    factor: f32,
) {
    naked_asm!(
        // The assembler does not know that the core has an FPU.
        ".fpu fpv4-sp-d16",
        "movw r3, #{rounding} & 0xffff",
        "movt r3, #{rounding} >> 16",
        "vmov s1, r3",
        "subs r3, r1, r0",
        "lsls r3, r3, #27",
        "bpl 1f",
        four_codes!(),
        "cmp r0, r1",
        "beq 2f",
        "1:",
        four_codes!(),
        four_codes!(),
        "cmp r0, r1",
        "bne 1b",
        "2:",
        "bx lr",
        rounding = const ROUNDING.to_bits(),
    )
}
