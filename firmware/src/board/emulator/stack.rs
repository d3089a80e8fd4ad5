//! The deepest stack: the start-up code fills it with a pattern, and words that differ were used.

use core::{
    fmt::Write as _,
    ptr,
    sync::atomic::{AtomicU32, Ordering},
};

use super::uart::Uart;
use crate::stack_guard;

/// The pattern of `cortex-m-rt` with the feature `paint-stack`.
const PAINT: u32 = 0xcccc_cccc;

/// Writes the most bytes that were ever used, if more than in the last report.
pub fn report(mut uart: Uart) {
    static REPORTED: AtomicU32 = AtomicU32::new(0);
    let used = used();
    if REPORTED.fetch_max(used, Ordering::Relaxed) < used {
        critical_section::with(|_| {
            let _ = writeln!(uart, "STACK {used}");
        });
    }
}

#[expect(unsafe_code, reason = "the unused stack is no Rust object")]
fn used() -> u32 {
    let top = stack_guard::top();
    // The guard below cannot be read.
    let mut word = ptr::with_exposed_provenance::<u32>(stack_guard::guard().end);
    // SAFETY: `word` stays between the guard and the top of the stack, one region of RAM, and is aligned.
    // Every word of it was initialised by the start-up code. Below the stack pointer it belongs to
    // no Rust object, and the loop ends at the first word that was ever used; a frame that holds
    // nothing but the pattern is only read, and volatile.
    while word.addr() < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    u32::try_from(top - word.addr()).unwrap_or(u32::MAX)
}
