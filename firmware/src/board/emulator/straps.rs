//! Configuration word that the emulator's loader writes before the program runs. A reset keeps it.

/// Factor by which the clock runs slower than real time, 1 if nothing was set.
///
/// With 5, the 200 ms of silence are a second of real time, so that a busy host does not look silent.
#[expect(
    unsafe_code,
    reason = "written by the emulator's loader, at an address of the linker script"
)]
pub fn time_scale() -> u64 {
    // SAFETY: memory.x defines the symbol, as the start of its region STRAPS.
    unsafe extern "C" {
        static _straps: u32;
    }
    // SAFETY: the symbol is the word-aligned start of memory that no section of the program is placed in. The loader
    // writes it before the program starts, and nothing does afterwards; any value is a valid `u32`.
    let scale = unsafe { (&raw const _straps).read_volatile() };
    u64::from(scale).max(1)
}
