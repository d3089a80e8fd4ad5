//! Median of three and rectification of four channels at once.

use core::arch::asm;

/// `|median|` of each byte, the operands signed and the result not.
///
/// `SSUB8` notes of each byte whether the difference is negative, exactly, and `SEL` chooses by it. The median is the
/// larger of min(before, after) and min(max(before, after), here).
#[inline(always)]
pub(super) fn four_rectified_medians(before: u32, here: u32, after: u32) -> u32 {
    let result;
    // SAFETY: arithmetic on the registers that are named; no memory, no stack. The flags count as changed.
    unsafe {
        asm!(
            "ssub8 {low}, {before}, {after}",
            "sel {high}, {before}, {after}",
            "sel {low}, {after}, {before}",
            "ssub8 {result}, {high}, {here}",
            "sel {high}, {here}, {high}",
            "ssub8 {result}, {high}, {low}",
            "sel {high}, {high}, {low}",
            "ssub8 {result}, {zero}, {high}",
            "sel {result}, {result}, {high}",
            before = in(reg) before,
            here = in(reg) here,
            after = in(reg) after,
            zero = in(reg) 0,
            low = out(reg) _,
            high = out(reg) _,
            result = out(reg) result,
            options(pure, nomem, nostack),
        );
    }
    result
}
