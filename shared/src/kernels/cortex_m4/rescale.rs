//! Scales integer sums to the outputs of a linear map.

use core::arch::naked_asm;

/// Four sums in s8 to s11 times s0 and four scales, and four terms of the bias.
macro_rules! four_outputs {
    () => {
        "vldmia r1!, {{s4, s5, s6, s7}}
         vldmia r2!, {{s12, s13, s14, s15}}
         vmul.f32 s4, s0, s4
         vmul.f32 s5, s0, s5
         vmul.f32 s6, s0, s6
         vmul.f32 s7, s0, s7
         vcvt.f32.s32 s8, s8
         vcvt.f32.s32 s9, s9
         vcvt.f32.s32 s10, s10
         vcvt.f32.s32 s11, s11
         vmul.f32 s8, s8, s4
         vmul.f32 s9, s9, s5
         vmul.f32 s10, s10, s6
         vmul.f32 s11, s11, s7
         vadd.f32 s8, s8, s12
         vadd.f32 s9, s9, s13
         vadd.f32 s10, s10, s14
         vadd.f32 s11, s11, s15"
    };
}

/// `outputs[r] = sum * (scale * scales[r]) + bias[r]`, the sum being the integer at `outputs[r]`.
///
/// # Safety
/// The scales up to `end` and as many terms of the bias are readable, a multiple of four, not 0; as many outputs are
/// readable and writable.
// SAFETY: the body is a whole function of the C calling convention with float arguments in registers, which every
// `eabihf` target has: it takes `scale` from s0 and the others from r0 to r3, changes only registers that a function may
// change, and returns to lr.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn rescale(
    outputs: *mut f32,
    scales: *const f32,
    bias: *const f32,
    end: *const f32,
    scale: f32,
) {
    naked_asm!(
        // The assembler does not know that the core has an FPU.
        ".fpu fpv4-sp-d16",
        "1:",
        "vldmia r0, {{s8, s9, s10, s11}}",
        four_outputs!(),
        "vstmia r0!, {{s8, s9, s10, s11}}",
        "cmp r1, r3",
        "bne 1b",
        "bx lr",
    )
}

/// `residual[r] += sums[r] * (scale * scales[r]) + bias[r]`, for `count` rows.
///
/// # Safety
/// Duties of [`rescale`], for the sums and for the residual stream, which is written too.
// SAFETY: as above, with the fifth integer argument on the stack.
#[unsafe(naked)]
pub(super) unsafe extern "C" fn add_rescaled(
    sums: *const i32,
    scales: *const f32,
    bias: *const f32,
    end: *const f32,
    residual: *mut f32,
    scale: f32,
) {
    naked_asm!(
        ".fpu fpv4-sp-d16",
        "ldr r12, [sp]",
        "1:",
        "vldmia r0!, {{s8, s9, s10, s11}}",
        four_outputs!(),
        "vldmia r12, {{s4, s5, s6, s7}}",
        "vadd.f32 s4, s4, s8",
        "vadd.f32 s5, s5, s9",
        "vadd.f32 s6, s6, s10",
        "vadd.f32 s7, s7, s11",
        "vstmia r12!, {{s4, s5, s6, s7}}",
        "cmp r1, r3",
        "bne 1b",
        "bx lr",
    )
}
