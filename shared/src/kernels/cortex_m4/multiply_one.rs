//! Matrix times one token.

use core::arch::naked_asm;

/// Columns of a pass: two groups. The number of columns is a multiple of it.
pub(super) const COLUMNS: usize = 8;

/// A group of a tile: four columns of four rows, whose inputs are in the two registers. A word of weights holds those of
/// columns 2 and 3; shifted by a byte, those of columns 0 and 1.
macro_rules! group {
    ($first:literal, $last:literal) => {
        concat!(
            "ldmia.w r0!, {{r8, r9, r10, r11}}\n",
            "smlad r4, r8, ",
            $last,
            ", r4\n",
            "lsl.w r8, r8, #8\n",
            "smlad r4, r8, ",
            $first,
            ", r4\n",
            "smlad r5, r9, ",
            $last,
            ", r5\n",
            "lsl.w r9, r9, #8\n",
            "smlad r5, r9, ",
            $first,
            ", r5\n",
            "smlad r6, r10, ",
            $last,
            ", r6\n",
            "lsl.w r10, r10, #8\n",
            "smlad r6, r10, ",
            $first,
            ", r6\n",
            "smlad r7, r11, ",
            $last,
            ", r7\n",
            "lsl.w r11, r11, #8\n",
            "smlad r7, r11, ",
            $first,
            ", r7\n",
        )
    };
}

/// Two groups of a tile: eight columns of four rows. 27 instructions for 32 products.
macro_rules! two_groups {
    () => {
        concat!(
            "ldmia.w r1!, {{r2, r3, r12, lr}}\n",
            group!("r2", "r3"),
            group!("r12", "lr"),
        )
    };
}

/// Whole tiles: `sums[4 t + r] = sum over c of tiles[t][r][c] * input[c]`.
///
/// Registers: r0 weights, r1 input, r2, r3, r12 and lr eight inputs, r4 to r7 the tile's sums, r8 to r11 a group's
/// weights by row. What is needed once per tile is on the stack. The loop is unrolled eight times; if the number of
/// pairs of groups is not a multiple of eight, a tile enters the first pass at a later pair.
///
/// # Safety
/// `columns` inputs are readable, a multiple of [`COLUMNS`], not 0. The sums up to `sums_end` are writable, a
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
        // and their end, which is an argument on the caller's stack; the end of the input.
        "push {{r2, r3, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "sub sp, #4",
        "ldr r4, [sp, #48]",
        "strd r2, r4, [sp]",
        "add r2, r1, r3, lsl #1",
        "str r2, [sp, #8]",
        // Pairs of groups to skip in the first pass: (8 - pairs) modulo 8.
        "ubfx r3, r3, #3, #3",
        "rsb r3, r3, #8",
        "and r3, r3, #7",
        "movs r4, #{bytes}",
        "mul r3, r3, r4",
        "adr r4, 2f",
        "add r3, r3, r4",
        "orr r3, r3, #1",
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
        two_groups!(),
        two_groups!(),
        two_groups!(),
        two_groups!(),
        two_groups!(),
        two_groups!(),
        two_groups!(),
        two_groups!(),
        "ldr r2, [sp, #32]",
        "cmp r1, r2",
        "bne 2b",
        "ldrd r3, r12, [sp, #24]",
        "stmia r3!, {{r4, r5, r6, r7}}",
        "str r3, [sp, #24]",
        "cmp r3, r12",
        "bne 1b",
        "add sp, #36",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        bytes = const BYTES,
    )
}

/// Bytes of code of two groups: 27 instructions of four bytes.
const BYTES: usize = 108;
