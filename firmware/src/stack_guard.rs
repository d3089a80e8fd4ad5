//! A part of RAM below the stack that nothing may access: a stack that grows too deep faults instead of
//! overwriting variables.
//!
//! The core's memory protection unit does it, with two regions side by side: one of their size together would waste
//! more by its alignment. The rest of memory is as without it. Hard faults, which have a priority below zero, are not
//! subject to it, so the handler can run in the guard until it takes a fresh stack. The SoftDevices protect their
//! own memory by another unit (MWU) and leave this one to the program; their interrupts use this stack too.
//!
//! A frame larger than the guard that never writes to it would jump over it. No such frame is known.

use core::ops::Range;

use cortex_m::peripheral::{MPU, SCB};

/// Size and alignment of a region.
const REGION: usize = 256;
/// Bytes that may not be accessed.
const GUARD: usize = REGION * REGIONS.len();
/// Numbers of the regions: the highest of eight.
const REGIONS: [u32; 2] = [6, 7];
/// MPU_RASR: execute never, no access, 2^8 bytes, enabled (Armv7-M Architecture Reference Manual, B3.5.9).
const NO_ACCESS: u32 = 1 << 28 | (8 - 1) << 1 | 1;
/// MPU_CTRL: enabled, with the usual map as background, not for hard faults (B3.5.5).
const WITH_BACKGROUND: u32 = 1 << 2 | 1;
/// CFSR: a data access was refused; saving registers on the stack was refused, floating-point ones too; MMFAR
/// holds the address (B3.2.15).
const DATA_REFUSED: u32 = 1 << 1;
const STACKING_REFUSED: u32 = 1 << 4 | 1 << 5;
const ADDRESS_VALID: u32 = 1 << 7;

/// Starts guarding. To be called before the stack is deep.
#[expect(
    unsafe_code,
    reason = "the memory protection unit has no safe interface"
)]
pub fn start() {
    let bases = guard().step_by(REGION);
    // SAFETY: nothing else in this program uses the unit, and nothing has started yet. The regions cover parts of
    // the memory between the variables and the stack, see `guard`, which holds no Rust object: an access to it is
    // a stack overflow. All other memory stays as it is by the background map.
    unsafe {
        let mpu = &*MPU::PTR;
        for (number, base) in REGIONS.into_iter().zip(bases) {
            mpu.rnr.write(number);
            mpu.rbar.write(u32::try_from(base).unwrap_or(u32::MAX));
            mpu.rasr.write(NO_ACCESS);
        }
        mpu.ctrl.write(WITH_BACKGROUND);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Addresses that may not be accessed: whole regions directly above the variables.
pub fn guard() -> Range<usize> {
    let (end, _) = stack();
    let start = end.next_multiple_of(REGION);
    start..start + GUARD
}

/// Whether the present hard fault is an access to the guard.
#[expect(
    unsafe_code,
    reason = "only a raw pointer leads to a fault's registers"
)]
pub fn was_hit() -> bool {
    // SAFETY: the registers exist in every Armv7-M core; reading them has no effect.
    let (status, address) = unsafe {
        let scb = &*SCB::PTR;
        (scb.cfsr.read(), scb.mmfar.read())
    };
    let in_guard = guard().contains(&(address as usize));
    let data = DATA_REFUSED | ADDRESS_VALID;
    status & STACKING_REFUSED != 0 || status & data == data && in_guard
}

/// Continues with `end` on an empty stack: what was on it is lost.
#[expect(unsafe_code, reason = "a function cannot give up its own stack safely")]
pub fn leave(end: extern "C" fn() -> !) -> ! {
    let (_, top) = stack();
    let top = core::ptr::with_exposed_provenance(top);
    // SAFETY: `top` is the initial stack pointer, 8-byte aligned by link.x. `end` never returns, so nothing that
    // the stack held is ever used again; interrupts are off, see the caller, and in a hard fault none can come.
    unsafe { cortex_m::asm::bootstrap(top, end as *const u32) }
}

/// The lowest and the highest address of the stack.
#[expect(
    unsafe_code,
    reason = "only the linker script knows where the stack lies"
)]
fn stack() -> (usize, usize) {
    // SAFETY: link.x of cortex-m-rt defines both symbols, as the ends of the stack. Only their addresses are used.
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    (
        (&raw const _stack_end).addr(),
        (&raw const _stack_start).addr(),
    )
}
