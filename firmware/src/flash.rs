//! The parts of flash that the program writes: regions of `memory.x` of their own, which no section of the program lies in.

use embassy_sync::{
    blocking_mutex::raw::NoopRawMutex,
    mutex::{Mutex, MutexGuard},
};

/// Bytes of a page, which flash is erased by.
pub const PAGE_BYTES: u32 = 4096;

/// A page was not erased, or words were not written.
pub struct FlashFailed;

/// Erases and writes flash, in the way that the board's Bluetooth stack demands.
///
/// The futures must not be dropped before they end.
pub trait Flash {
    /// Erases the page that begins at this address, to ones.
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed>;

    /// Writes whole words, which begin at a word in memory, to an address that was erased.
    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed>;
}

/// Flash, which tasks write in turns; and the turn of the radio, which an erasure may have to wait for.
pub struct SharedFlash<F> {
    flash: Mutex<NoopRawMutex, F>,
    radio_turn: Mutex<NoopRawMutex, ()>,
}

impl<F> SharedFlash<F> {
    pub const fn new(flash: F) -> Self {
        Self {
            flash: Mutex::new(flash),
            radio_turn: Mutex::new(()),
        }
    }

    pub async fn lock(&self) -> MutexGuard<'_, NoopRawMutex, F> {
        self.flash.lock().await
    }

    /// Waits for the turn of the radio. The driver holds it while it uses a radio that leaves an erasure no time, an erasure
    /// while it needs the radio idle.
    pub async fn radio_turn(&self) -> MutexGuard<'_, NoopRawMutex, ()> {
        self.radio_turn.lock().await
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Region {
    /// The wearer's calibration: a page.
    Calibration,
    /// The bound armband: a page.
    Binding,
    /// The journal of an installation: a page.
    Journal,
    /// The outputs to a computer: a page.
    #[cfg(feature = "uf2")]
    Hid,
    Model,
}

impl Region {
    pub fn address(self, offset: u32) -> u32 {
        let (start, _) = bounds(self);
        start + offset
    }

    pub fn length(self) -> u32 {
        let (start, end) = bounds(self);
        end - start
    }

    /// Reads some bytes; erased ones where the region has none.
    pub fn read<const N: usize>(self, offset: u32) -> [u8; N] {
        let mut bytes = [0xff; N];
        for (byte, offset) in bytes.iter_mut().zip(offset..self.length()) {
            *byte = read(self, offset);
        }
        bytes
    }
}

#[cfg(target_os = "none")]
pub use memory::bytes;
#[cfg(target_os = "none")]
use memory::{bounds, read};
#[cfg(not(target_os = "none"))]
use simulated::{bounds, read};
#[cfg(not(target_os = "none"))]
pub use simulated::{bytes, contents, erase, insert, program};

#[cfg(target_os = "none")]
mod memory {
    use core::{ptr, slice};

    use super::{PAGE_BYTES, Region};

    /// Bounds of a region.
    #[expect(
        unsafe_code,
        reason = "only the linker script knows where the regions lie"
    )]
    pub fn bounds(region: Region) -> (u32, u32) {
        // SAFETY: memory.x defines the symbols, as the ends of its regions. Only their addresses are used.
        unsafe extern "C" {
            static _calibration_start: u8;
            static _binding_start: u8;
            static _journal_start: u8;
            #[cfg(feature = "uf2")]
            static _hid_start: u8;
            static _model_start: u8;
            static _model_end: u8;
        }
        // The cores have 32-bit addresses.
        let page = |start: *const u8| (start.addr() as u32, start.addr() as u32 + PAGE_BYTES);
        match region {
            Region::Calibration => page(&raw const _calibration_start),
            Region::Binding => page(&raw const _binding_start),
            Region::Journal => page(&raw const _journal_start),
            #[cfg(feature = "uf2")]
            Region::Hid => page(&raw const _hid_start),
            Region::Model => (
                (&raw const _model_start).addr() as u32,
                (&raw const _model_end).addr() as u32,
            ),
        }
    }

    /// Reads a byte inside of a region.
    #[expect(unsafe_code, reason = "the region is no Rust object")]
    pub fn read(region: Region, offset: u32) -> u8 {
        let byte = ptr::with_exposed_provenance::<u8>(region.address(offset) as usize);
        // SAFETY: the caller has checked that the byte lies in the region, which is memory that every board has, and no
        // section of the program is placed in it. Any byte is a valid `u8`. It changes only while `Flash` writes it, on the
        // same executor; volatile, because the compiler does not see that.
        unsafe { byte.read_volatile() }
    }

    /// The whole of a region that what is in use borrows from: the model's, or the calibration's.
    #[expect(
        unsafe_code,
        reason = "only the linker script knows where the region lies"
    )]
    pub fn bytes(region: Region) -> &'static [u8] {
        let start = ptr::with_exposed_provenance(region.address(0) as usize);
        // SAFETY: the addresses of the region are flash that every board has and that no section of the program is placed
        // in, so no other Rust object overlaps them. Any byte is a valid `u8`, and alignment is 1. The program writes it in
        // one place, `installation`, and there only after the inference has given up what it borrowed and for as long as no
        // model is in use; a slice that was given before is not read then, and a fresh one is made after. The region has at
        // most 160 KiB, far below `isize::MAX`.
        unsafe { slice::from_raw_parts(start, region.length() as usize) }
    }
}

#[cfg(not(target_os = "none"))]
mod simulated {
    use std::sync::{Mutex, MutexGuard, PoisonError};

    use super::{PAGE_BYTES, Region};

    /// Simulated flash, from the calibration to the end of the model, where `memory.x` has them.
    const START: u32 = 0x5_5000;
    const END: u32 = 0x8_0000;

    static MEMORY: Mutex<Vec<u8>> = Mutex::new(Vec::new());

    fn lock() -> MutexGuard<'static, Vec<u8>> {
        let mut memory = MEMORY.lock().unwrap_or_else(PoisonError::into_inner);
        memory.resize((END - START) as usize, 0xff);
        memory
    }

    pub fn bounds(region: Region) -> (u32, u32) {
        match region {
            Region::Calibration => (START, START + PAGE_BYTES),
            Region::Journal => (START + PAGE_BYTES, START + 2 * PAGE_BYTES),
            Region::Binding => (START + 2 * PAGE_BYTES, START + 3 * PAGE_BYTES),
            Region::Model => (START + 3 * PAGE_BYTES, END),
        }
    }

    pub fn read(region: Region, offset: u32) -> u8 {
        lock()[(region.address(offset) - START) as usize]
    }

    /// The whole of a region, as it is now.
    pub fn bytes(region: Region) -> &'static [u8] {
        contents(region).leak()
    }

    /// Whatever a region holds.
    pub fn contents(region: Region) -> Vec<u8> {
        let (start, end) = bounds(region);
        lock()[(start - START) as usize..(end - START) as usize].to_vec()
    }

    /// Sets the start of a region; the rest of it is erased.
    pub fn insert(region: Region, bytes: &[u8]) {
        let (start, end) = bounds(region);
        let mut memory = lock();
        let region = &mut memory[(start - START) as usize..(end - START) as usize];
        let length = bytes.len().min(region.len());
        region.fill(0xff);
        region[..length].copy_from_slice(&bytes[..length]);
    }

    pub fn erase(address: u32, length: u32) {
        let from = (address - START) as usize;
        lock()[from..from + length as usize].fill(0xff);
    }

    /// Writes bytes, as flash is written: ones to zeros.
    pub fn program(address: u32, words: &[u8]) {
        let from = (address - START) as usize;
        for (byte, content) in lock()[from..].iter_mut().zip(words) {
            *byte &= content;
        }
    }
}
