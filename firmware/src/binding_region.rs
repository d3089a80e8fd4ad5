//! The part of flash that holds the bound armband (`BINDING` in `memory.x`): a page of its own, which neither a new program
//! nor a new model touches.

use shared::myo::Address;
use shared::myo::binding::{RECORD_BYTES, from_record, to_record};

/// A record as flash is written: from the start of a word.
#[repr(align(4))]
pub struct Record(pub [u8; RECORD_BYTES]);

/// The page was not erased or not written.
pub struct PageFailed;

/// Erases and writes the region, in the way that the board's Bluetooth stack demands.
///
/// Its futures must not be dropped before they end.
pub trait Page {
    /// Erases all of it, to ones.
    async fn erase(&mut self) -> Result<(), PageFailed>;

    /// Writes a record to its start, which was erased.
    async fn write(&mut self, record: &Record) -> Result<(), PageFailed>;
}

/// The armband that is kept; none if the page holds no whole record.
pub fn load() -> Option<Address> {
    from_record(&bytes())
}

/// Keeps an armband, or none; gives whether the page holds that now. Does nothing if it does already.
///
/// A loss of power in between leaves no whole record: then none is bound.
pub async fn keep(page: &mut impl Page, armband: Option<Address>) -> bool {
    if load() != armband {
        let erased = page.erase().await;
        if let (Ok(()), Some(armband)) = (erased, armband) {
            // What came of it is read.
            let _ = page.write(&Record(to_record(armband))).await;
        }
    }
    load() == armband
}

#[cfg(target_os = "none")]
use flash::bytes;
#[cfg(target_os = "none")]
pub use flash::start;
#[cfg(not(target_os = "none"))]
use simulated::bytes;
#[cfg(not(target_os = "none"))]
pub use simulated::write;

#[cfg(target_os = "none")]
mod flash {
    use core::ptr;

    use super::RECORD_BYTES;

    /// Address of the region's first byte.
    #[expect(
        unsafe_code,
        reason = "only the linker script knows where the region lies"
    )]
    pub fn start() -> u32 {
        // SAFETY: memory.x defines the symbol, as the start of its region BINDING. Only its address is used.
        unsafe extern "C" {
            static _binding_start: u8;
        }
        // The cores have 32-bit addresses.
        (&raw const _binding_start).addr() as u32
    }

    #[expect(unsafe_code, reason = "the region is no Rust object")]
    pub fn bytes() -> [u8; RECORD_BYTES] {
        let record = ptr::with_exposed_provenance::<[u8; RECORD_BYTES]>(start() as usize);
        // SAFETY: the region is memory that every board has, of a page, longer than a record, and no section of the program
        // is placed in it, so no Rust object overlaps it. Any byte is a valid `u8`, and alignment is 1. It changes only
        // while `Page` writes it, on the same executor and awaited by the only caller; volatile, because the compiler
        // does not see that.
        unsafe { record.read_volatile() }
    }
}

#[cfg(not(target_os = "none"))]
mod simulated {
    use std::sync::Mutex;

    use super::RECORD_BYTES;

    static PAGE: Mutex<[u8; RECORD_BYTES]> = Mutex::new([0xff; RECORD_BYTES]);

    /// Writes the start of the region.
    pub fn write(record: [u8; RECORD_BYTES]) {
        *PAGE.lock().expect("nobody panics while writing") = record;
    }

    pub fn bytes() -> [u8; RECORD_BYTES] {
        *PAGE.lock().expect("nobody panics while writing")
    }
}
