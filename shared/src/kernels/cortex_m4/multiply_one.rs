//! Matrix times one token.

use core::arch::naked_asm;

/// One group of a tile: four columns of four rows. 18 instructions for 16 products.
macro_rules! group {
    () => {
        "ldmia.w r0!, {{r8, r9, r10, r11}}
         ldrd r12, lr, [r1], #8
         sxtb16 r3, r8
         smlad r4, r3, r12, r4
         sxtb16 r3, r8, ror #8
         smlad r4, r3, lr, r4
         sxtb16 r3, r9
         smlad r5, r3, r12, r5
         sxtb16 r3, r9, ror #8
         smlad r5, r3, lr, r5
         sxtb16 r3, r10
         smlad r6, r3, r12, r6
         sxtb16 r3, r10, ror #8
         smlad r6, r3, lr, r6
         sxtb16 r3, r11
         smlad r7, r3, r12, r7
         sxtb16 r3, r11, ror #8
         smlad r7, r3, lr, r7"
    };
}

/// Whole tiles: `sums[4 t + r] = sum over c of tiles[t][r][c] * input[c]`.
///
/// Registers: r0 weights, r1 input, r2 its end, r3 scratch, r4 to r7 the tile's sums, r8 to r11 a group's
/// weights by row, r12 and lr its inputs. What is needed once per tile is on the stack. The loop is
/// unrolled eight times; if the number of groups is no multiple of eight, a tile enters the first pass
/// at a later group.
///
/// # Safety
/// `columns` inputs are readable, a multiple of four, not 0. The sums up to `sums_end` are writable, a
/// multiple of four, not 0, and as many rows of `columns` weights are readable. All of them lie at
/// multiples of four bytes.
// SAFETY: the body is a whole function of the C calling convention: it takes its arguments from r0 to
// r3 and the stack, keeps r4 to r11 and the stack pointer, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn multiply_one(
    weights: *const i8,
    input: *const i16,
    sums: *mut i32,
    columns: usize,
    sums_end: *mut i32,
) {
    naked_asm!(
        // [sp]: start values of a tile: the input, the entry into the loop, four zeros. [sp + 24]: the sums
        // and their end, which is an argument on the caller's stack.
        "push {{r2, r3, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "add r2, r1, r3, lsl #1",
        // Groups to skip in the first pass: (8 - groups) modulo 8.
        "ubfx r3, r3, #2, #3",
        "rsb r3, r3, #8",
        "and r3, r3, #7",
        "movs r4, #{group_bytes}",
        "mul r3, r3, r4",
        "adr r4, 2f",
        "add r3, r3, r4",
        "orr r3, r3, #1",
        "ldr r4, [sp, #44]",
        "str r4, [sp, #4]",
        "movs r4, #0",
        "movs r5, #0",
        "movs r6, #0",
        "movs r7, #0",
        "push {{r1, r3, r4, r5, r6, r7}}",
        "1:",
        "ldm.w sp, {{r1, r3, r4, r5, r6, r7}}",
        "bx r3",
        ".p2align 2",
        "2:",
        group!(),
        group!(),
        group!(),
        group!(),
        group!(),
        group!(),
        group!(),
        group!(),
        "cmp r1, r2",
        "bne 2b",
        "ldrd r3, r12, [sp, #24]",
        "stmia r3!, {{r4, r5, r6, r7}}",
        "str r3, [sp, #24]",
        "cmp r3, r12",
        "bne 1b",
        "add sp, #32",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        group_bytes = const GROUP_BYTES,
    )
}

/// Bytes of code of a group: 18 instructions of four bytes.
const GROUP_BYTES: usize = 72;
