//! Products of queries with keys, and of attention weights with values.

use core::arch::naked_asm;

/// Rows of [`four_rows`].
pub(super) const ROWS: usize = 4;
/// Columns of [`eight_columns`].
pub(super) const COLUMNS: usize = 8;

/// `sums[r] = sum over c of rows[r * stride + c] * codes[c]` for four rows, `stride` in bytes.
///
/// Registers: r0 codes, r1 to r4 rows, r5 to r8 their sums, r9 to r12 two words of the codes and two of a
/// row, lr end of the codes. 15 instructions for 16 products.
///
/// # Safety
/// The codes up to `end` are readable, a multiple of four, not 0; so are as many values of each row; all
/// of them lie at multiples of four bytes; four sums are writable.
// SAFETY: the body is a whole function of the C calling convention: it takes its arguments from r0 to
// r3 and the stack, keeps r4 to r11 and the stack pointer, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn four_rows(
    codes: *const i16,
    rows: *const i16,
    stride: usize,
    end: *const i16,
    sums: *mut i32,
) {
    naked_asm!(
        "push {{r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "mov lr, r3",
        "add r3, r1, r2, lsl #1",
        "add r4, r3, r2",
        "add r2, r1",
        "movs r5, #0",
        "movs r6, #0",
        "movs r7, #0",
        "mov r8, #0",
        "1:",
        "ldrd r9, r10, [r0], #8",
        "ldrd r11, r12, [r1], #8",
        "smlad r5, r11, r9, r5",
        "smlad r5, r12, r10, r5",
        "ldrd r11, r12, [r2], #8",
        "smlad r6, r11, r9, r6",
        "smlad r6, r12, r10, r6",
        "ldrd r11, r12, [r3], #8",
        "smlad r7, r11, r9, r7",
        "smlad r7, r12, r10, r7",
        "ldrd r11, r12, [r4], #8",
        "smlad r8, r11, r9, r8",
        "smlad r8, r12, r10, r8",
        "cmp r0, lr",
        "bne 1b",
        "ldr r0, [sp, #36]",
        "stmia r0, {{r5, r6, r7, r8}}",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
    )
}

/// Eight columns of one row, whose weight is the low (`b`) or the high (`t`) half of r12.
macro_rules! row {
    ($half:literal) => {
        concat!(
            "ldr lr, [r1]\n",
            "smlab",
            $half,
            " r4, lr, r12, r4\n",
            "smlat",
            $half,
            " r5, lr, r12, r5\n",
            "ldr lr, [r1, #4]\n",
            "smlab",
            $half,
            " r6, lr, r12, r6\n",
            "smlat",
            $half,
            " r7, lr, r12, r7\n",
            "ldr lr, [r1, #8]\n",
            "smlab",
            $half,
            " r8, lr, r12, r8\n",
            "smlat",
            $half,
            " r9, lr, r12, r9\n",
            "ldr lr, [r1, #12]\n",
            "smlab",
            $half,
            " r10, lr, r12, r10\n",
            "smlat",
            $half,
            " r11, lr, r12, r11\n",
            "add r1, r2",
        )
    };
}

/// `sums[c] = sum over r of weights[r] * rows[r * stride + c]` for eight columns, `stride` in bytes.
///
/// Registers: r0 weights, r1 row, r2 stride, r3 remaining pairs of rows, r4 to r11 sums, r12 two weights,
/// lr two values.
///
/// # Safety
/// `count` weights, two or more, are readable, and eight values of as many rows; all of them lie at
/// multiples of four bytes; eight sums are writable.
// SAFETY: the body is a whole function of the C calling convention: it takes its arguments from r0 to
// r3 and the stack, keeps r4 to r11 and the stack pointer, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn eight_columns(
    weights: *const i16,
    rows: *const i16,
    stride: usize,
    count: usize,
    sums: *mut i32,
) {
    naked_asm!(
        "push {{r3, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "lsrs r3, r3, #1",
        "movs r4, #0",
        "movs r5, #0",
        "movs r6, #0",
        "movs r7, #0",
        "mov r8, #0",
        "mov r9, #0",
        "mov r10, #0",
        "mov r11, #0",
        "1:",
        "ldr r12, [r0], #4",
        row!("b"),
        row!("t"),
        "subs r3, #1",
        "bne 1b",
        "pop {{r3}}",
        "lsls r3, r3, #31",
        "beq 2f",
        "ldrh r12, [r0]",
        row!("b"),
        "2:",
        "ldr r0, [sp, #36]",
        "stmia r0, {{r4, r5, r6, r7, r8, r9, r10, r11}}",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
    )
}
