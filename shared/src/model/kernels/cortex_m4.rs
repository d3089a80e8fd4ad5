//! The inner loops for the DSP instructions of a Cortex-M4.
//!
//! Equal to [`Portable`] bit for bit. Where an operand does not begin at a multiple of four bytes, as
//! several words can only be loaded from there, [`Portable`] itself answers.

#![allow(unsafe_code, reason = "the kernels are the one place for it")]

use core::arch::naked_asm;

use super::portable::{Portable, factors};
use super::{GROUP, Kernels, TILE_ROWS};
use crate::model::arithmetic::ROUNDING;

/// `SXTB16`, `SMLAD` and their relatives.
#[derive(Clone, Copy, Debug)]
pub struct CortexM4;

impl Kernels for CortexM4 {
    #[inline]
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], mut sums: [&mut [i32]; T]) {
        let columns = inputs.first().map_or(0, |input| input.len());
        let fits = inputs
            .iter()
            .zip(&sums)
            .all(|(input, sums)| input.len() == columns && multiply_fits(weights, input, sums));
        if !fits {
            return elsewhere(|| Portable::multiply(weights, inputs, sums));
        }
        let (input_pairs, last_input) = inputs.as_chunks();
        let (sum_pairs, last_sums) = sums.as_chunks_mut();
        for ([input, next_input], [sums, next_sums]) in input_pairs.iter().zip(sum_pairs) {
            // SAFETY: as below, for both; as many columns and rows, for one matrix fits both.
            unsafe {
                multiply_tiles_by_two(
                    weights.as_ptr(),
                    input.as_ptr(),
                    next_input.as_ptr(),
                    input.len(),
                    sums.as_mut_ptr(),
                    next_sums.as_mut_ptr(),
                    sums.as_mut_ptr_range().end,
                );
            }
        }
        if let ([input], [sums]) = (last_input, last_sums) {
            // SAFETY: whole tiles, one or more, of rows as long as `input`, which is one group or more; `sums` has a
            // place for each of their rows; all operands begin at a multiple of four.
            unsafe {
                multiply_tiles(
                    weights.as_ptr(),
                    input.as_ptr(),
                    sums.as_mut_ptr(),
                    input.len(),
                    sums.as_mut_ptr_range().end,
                );
            }
        }
    }

    #[inline]
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        let (columns, count) = (codes.len(), sums.len());
        let fits = columns > 0
            && columns.is_multiple_of(4)
            && stride.is_multiple_of(2)
            && count >= BLOCK
            && (count - 1) * stride + columns <= rows.len()
            && is_aligned(codes)
            && is_aligned(rows);
        if !fits {
            return elsewhere(|| Portable::row_products(codes, rows, stride, sums));
        }
        blocks(count, BLOCK, |start| {
            // SAFETY: the last of the four rows ends within `rows`, as `start` is at most `count - 4`; `sums` has
            // four places from there; all words are aligned, and there is a group of columns.
            unsafe {
                four_rows(
                    codes.as_ptr(),
                    rows.as_ptr().add(start * stride),
                    stride * size_of::<i16>(),
                    codes.as_ptr_range().end,
                    sums.as_mut_ptr().add(start),
                );
            }
        });
    }

    #[inline]
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        let (count, columns) = (weights.len(), sums.len());
        let fits = count > 1
            && columns >= COLUMNS
            && columns.is_multiple_of(2)
            && stride.is_multiple_of(2)
            && (count - 1) * stride + columns <= rows.len()
            && is_aligned(weights)
            && is_aligned(rows);
        if !fits {
            return elsewhere(|| Portable::weighted_rows(weights, rows, stride, sums));
        }
        blocks(columns, COLUMNS, |start| {
            // SAFETY: the last of the eight columns ends within the last row, as `start` is at most `columns - 8`, and
            // is even as both of these are; `sums` has eight places from there; there are two rows or more.
            unsafe {
                eight_columns(
                    weights.as_ptr(),
                    rows.as_ptr().add(start),
                    stride * size_of::<i16>(),
                    count,
                    sums.as_mut_ptr().add(start),
                );
            }
        });
    }

    #[inline]
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
        let fits = values.len() == codes.len()
            && !values.is_empty()
            && values.len().is_multiple_of(4)
            && is_aligned(codes);
        if !fits {
            return elsewhere(|| Portable::quantize(values, limit, codes));
        }
        let values = values.as_ptr_range();
        // SAFETY: all of `values`, a multiple of four and not 0.
        let largest = unsafe { absmax_bits(values.start, values.end) };
        let Some(factors) = factors(f32::from_bits(largest), limit) else {
            codes.fill(0);
            return 0.0;
        };
        // SAFETY: as before; there are as many codes, at a multiple of four bytes.
        unsafe {
            round_to_codes(
                values.start,
                values.end,
                codes.as_mut_ptr(),
                factors.to_codes,
            );
        }
        factors.to_values
    }
}

/// Whether the matrix is one of whole tiles for this input and these sums, all of it aligned.
#[inline(always)]
fn multiply_fits(weights: &[i8], input: &[i16], sums: &[i32]) -> bool {
    !input.is_empty()
        && input.len().is_multiple_of(GROUP)
        && !sums.is_empty()
        && sums.len().is_multiple_of(TILE_ROWS)
        && weights.len() == sums.len() * input.len()
        && is_aligned(weights)
        && is_aligned(input)
}

/// Out of the way: what hardly ever happens shall not take the stack of what does.
#[cold]
#[inline(never)]
fn elsewhere<T>(form: impl FnOnce() -> T) -> T {
    form()
}

/// Begins a block of `size` at each multiple of it below `count`, `size` at least. The last one moves up to end
/// with the end; what it does twice it does alike.
#[inline(always)]
fn blocks(count: usize, size: usize, mut begin: impl FnMut(usize)) {
    let mut done = 0;
    while done < count {
        begin(done.min(count - size));
        done += size;
    }
}

/// Rows that [`four_rows`] takes.
const BLOCK: usize = 4;

/// Columns that [`eight_columns`] takes.
const COLUMNS: usize = 8;

fn is_aligned<T>(slice: &[T]) -> bool {
    slice.as_ptr().addr().is_multiple_of(4)
}

/// `sums[r] = sum over c of rows[r * stride + c] * codes[c]` for four rows, `stride` in bytes.
///
/// r0 the codes, r1 to r4 the rows, r5 to r8 their sums, r9 to r12 two words of the codes and of a row, lr
/// the codes' end. 15 instructions for 16 products.
///
/// # Safety
/// Codes up to `end`, a multiple of four and not 0; as many in each of the rows; all words aligned; room for
/// four sums.
#[unsafe(naked)]
unsafe extern "C" fn four_rows(
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

/// One row's share of eight columns: its weight is the low (`b`) or the high (`t`) half of r12.
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
/// r0 the weights, r1 a row, r3 pairs of rows to do, r4 to r11 the sums, r12 two weights, lr two values.
///
/// # Safety
/// `count` weights, two or more, and as many rows with eight values each; all words aligned; room for eight sums.
#[unsafe(naked)]
unsafe extern "C" fn eight_columns(
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

/// Four values more for [`absmax_bits`].
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

/// The bits of the largest magnitude: ordered as the magnitudes are, and above all of them for a NaN.
///
/// r2 twice the largest so far, the sign shifted out.
///
/// # Safety
/// Values up to `end`, a multiple of four and not 0.
#[unsafe(naked)]
unsafe extern "C" fn absmax_bits(values: *const f32, end: *const f32) -> u32 {
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

/// Four codes more for [`round_to_codes`].
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
/// By adding 1.5 x 2^23, as [`round_to_even`](crate::model::arithmetic::round_to_even) does: the code is the low half of
/// the sum, and two of them make a word.
///
/// # Safety
/// Values up to `end`, a multiple of four and not 0; as many codes, aligned.
#[unsafe(naked)]
unsafe extern "C" fn round_to_codes(
    values: *const f32,
    end: *const f32,
    codes: *mut i16,
    factor: f32,
) {
    naked_asm!(
        // The assembler is not told of the target's floats, the core has them.
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
/// r0 the weights, r1 the input, r2 its end, r3 scratch, r4 to r7 the tile's sums, r8 to r11 a group's
/// weights by row, r12 and lr its inputs. No register is left for what is needed once a tile: it waits on the
/// stack. Eight groups make a round; a tile begins inside the first one if its columns are no whole rounds.
///
/// # Safety
/// Whole tiles of rows of `columns` weights, a multiple of four and not 0, up to where `sums` ends, and `columns`
/// inputs, all of it aligned; one tile or more.
#[unsafe(naked)]
unsafe extern "C" fn multiply_tiles(
    weights: *const i8,
    input: *const i16,
    sums: *mut i32,
    columns: usize,
    sums_end: *mut i32,
) {
    naked_asm!(
        // [sp]: what a tile begins with, the input, where in the round, four zeros; [sp + 24]: the sums and their
        // end, which comes from the caller's stack.
        "push {{r2, r3, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "add r2, r1, r3, lsl #1",
        // Groups beyond whole rounds; the round is left out up to them: 8 - groups, if there are any.
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

/// Code of a group: 18 instructions, all of them four bytes long.
const GROUP_BYTES: usize = 72;

/// One group of half a tile for two tokens: four columns of two rows. 15 instructions for 16 products.
macro_rules! group_by_two {
    () => {
        "ldrd r8, r9, [r0], #16
         ldrd r10, r11, [r1], #8
         ldrd r12, lr, [r2], #8
         sxtb16 r3, r8
         smlad r4, r3, r10, r4
         smlad r5, r3, r12, r5
         sxtb16 r3, r8, ror #8
         smlad r4, r3, r11, r4
         smlad r5, r3, lr, r5
         sxtb16 r3, r9
         smlad r6, r3, r10, r6
         smlad r7, r3, r12, r7
         sxtb16 r3, r9, ror #8
         smlad r6, r3, r11, r6
         smlad r7, r3, lr, r7"
    };
}

/// As [`multiply_tiles`] for two tokens: half a tile at a time, two rows, whose weights are loaded and unpacked once
/// for both.
///
/// r0 the weights, r1 and r2 the inputs, r3 scratch, r4 to r7 the sums, row after row, r8 and r9 a group's weights,
/// r10 to lr its inputs. What is needed once a half waits on the stack.
///
/// # Safety
/// As [`multiply_tiles`], for each token; `sums_end` is that of the first one's.
#[unsafe(naked)]
unsafe extern "C" fn multiply_tiles_by_two(
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
        // [sp]: what a half begins with, the inputs, where in the round, four zeros; [sp + 28]: the way from the end of
        // a half to the next one, and of that one; [sp + 36]: both sums, the end of the first, the end of its input.
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
        // As in `multiply_tiles`.
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

/// Code of a group for two tokens: 15 instructions, all of them four bytes long.
const GROUP_BY_TWO_BYTES: usize = 60;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::kernels::checks;

    #[test]
    fn the_dsp_form_passes_the_catalogue() {
        let judged = checks::check::<CortexM4>().unwrap();
        assert_eq!(judged, checks::CASES);
    }
}
