//! What whoever starts the emulator may set before the program runs.

/// How many times slower than the wall the clock runs, 1 if nothing was set.
///
/// A busy machine then looks like a short pause: 200 ms of silence are seconds of the wall.
#[expect(
    unsafe_code,
    reason = "written by the emulator's loader, known to the linker script"
)]
pub fn time_scale() -> u64 {
    unsafe extern "C" {
        static _straps: u32;
    }
    // SAFETY: the linker script sets the symbol to an aligned word of a region that holds no
    // section; it is written before the program starts and never by it.
    let strapped = unsafe { (&raw const _straps).read_volatile() };
    u64::from(strapped).max(1)
}
