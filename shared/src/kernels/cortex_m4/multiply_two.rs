//! Matrix times two tokens, which share the loading and shifting of the weights.

use core::arch::naked_asm;

/// One group of half a tile for two tokens: four columns of two rows. 13 instructions for 16 products.
macro_rules! group_by_two {
    () => {
        "ldrd r8, r9, [r0], #16
         ldrd r10, r11, [r1], #8
         ldrd r12, lr, [r2], #8
         smlad r4, r8, r11, r4
         smlad r5, r8, lr, r5
         lsl.w r8, r8, #8
         smlad r4, r8, r10, r4
         smlad r5, r8, r12, r5
         smlad r6, r9, r11, r6
         smlad r7, r9, lr, r7
         lsl.w r9, r9, #8
         smlad r6, r9, r10, r6
         smlad r7, r9, r12, r7"
    };
}

/// As [`multiply_one`](super::multiply_one::multiply_one), for two tokens and half a tile at a time: two
/// rows, whose weights are loaded and shifted once for both tokens.
///
/// Registers: r0 weights, r1 and r2 inputs, r3 between loops, r4 to r7 sums by row and token, r8 and r9 a
/// group's weights, r10 to lr its inputs. What is needed once per half tile is on the stack.
///
/// # Safety
/// As [`multiply_one`](super::multiply_one::multiply_one), for each token; `sums_end` is the end of the
/// first token's sums.
// SAFETY: the body is a whole function of the C calling convention: it takes its arguments from r0 to
// r3 and the stack, keeps r4 to r11 and the stack pointer, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn multiply_two(
    weights: *const i8,
    input: *const i16,
    next_input: *const i16,
    columns: usize,
    sums: *mut i32,
    next_sums: *mut i32,
    sums_end: *mut i32,
) {
    naked_asm!(
        "push {{r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        // [sp]: start values of a half tile: the inputs, the entry into the loop, four zeros. [sp + 28]: the
        // distances of the weights from the end of this half to the next half, and from there on. [sp + 36]:
        // both sums, the end of the first, the end of the first input.
        "sub sp, #52",
        "strd r1, r2, [sp]",
        "add r4, r1, r3, lsl #1",
        "str r4, [sp, #48]",
        "movs r5, #0",
        "strd r5, r5, [sp, #12]",
        "strd r5, r5, [sp, #20]",
        "lsls r4, r3, #2",
        "rsb r4, r4, #8",
        "mvn r5, #7",
        "strd r4, r5, [sp, #28]",
        "ldrd r4, r5, [sp, #88]",
        "strd r4, r5, [sp, #36]",
        "ldr r4, [sp, #96]",
        "str r4, [sp, #44]",
        // As in `multiply_one`, by single groups.
        "ubfx r3, r3, #2, #3",
        "rsb r3, r3, #8",
        "and r3, r3, #7",
        "movs r4, #{group_bytes}",
        "mul r3, r3, r4",
        "adr r4, 2f",
        "add r3, r3, r4",
        "orr r3, r3, #1",
        "str r3, [sp, #8]",
        "1:",
        "ldm.w sp, {{r1, r2, r3, r4, r5, r6, r7}}",
        "bx r3",
        ".p2align 2",
        "2:",
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        group_by_two!(),
        "ldr r3, [sp, #48]",
        "cmp r1, r3",
        "bne 2b",
        "ldrd r3, r12, [sp, #28]",
        "strd r12, r3, [sp, #28]",
        "add r0, r3",
        "ldrd r3, r12, [sp, #36]",
        "strd r4, r6, [r3], #8",
        "strd r5, r7, [r12], #8",
        "strd r3, r12, [sp, #36]",
        "ldr r12, [sp, #44]",
        "cmp r3, r12",
        "bne 1b",
        "add sp, #52",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        group_bytes = const GROUP_BY_TWO_BYTES,
    )
}

/// Bytes of code of a group for two tokens: 13 instructions of four bytes.
const GROUP_BY_TWO_BYTES: usize = 52;
