//! Errata of the nRF52832 that embassy-nrf 0.11 leaves to the program.

use core::ptr;

/// Cycles in a microsecond.
const US: u32 = 64;
/// Microseconds after a reset or a stop of the low-frequency clock after which its RC oscillator may be started: erratum 132.
const OSCILLATOR_US: u32 = 138;

/// Works around errata 108 and 132. To be called after every reset, before the core sleeps and a clock is started.
pub fn work_around() {
    keep_ram_asleep();
    // embassy-nrf starts the oscillator at once. Started 66 to 138 us after a reset, it may not start at all.
    cortex_m::asm::delay(OSCILLATOR_US * US);
}

/// Erratum 108: after sleep RAM may hold anything, unless a trim value of the factory's is copied. Neither register has a name.
#[expect(unsafe_code, reason = "the registers are in no register crate")]
fn keep_ram_asleep() {
    const TRIM: usize = 0x1000_0258;
    const TRIMMED: usize = 0x4000_0ee4;
    const BITS: u32 = 0x4f;
    // SAFETY: both words exist on every nRF52832 (nRF52832 errata, 108), the first one in read-only memory. The workaround
    // is this copy, before the SoftDevice, which reserves the second one's peripheral, is enabled.
    unsafe {
        let trim = ptr::with_exposed_provenance::<u32>(TRIM).read_volatile();
        ptr::with_exposed_provenance_mut::<u32>(TRIMMED).write_volatile(trim & BITS);
    }
}
