//! The page of the bound armband: memory that a reset keeps. The program writes it as flash is written, word by word after
//! an erasure.

use core::ptr;

use shared::myo::binding::RECORD_BYTES;

use crate::binding_region::{self, Page, PageFailed, Record};

/// Memory in the place of a flash page.
pub struct MemoryPage;

impl Page for MemoryPage {
    async fn erase(&mut self) -> Result<(), PageFailed> {
        write(&[0xff; RECORD_BYTES]);
        Ok(())
    }

    async fn write(&mut self, record: &Record) -> Result<(), PageFailed> {
        write(&record.0);
        Ok(())
    }
}

#[expect(unsafe_code, reason = "the page is no Rust object")]
fn write(bytes: &[u8; RECORD_BYTES]) {
    let start = ptr::with_exposed_provenance_mut::<u32>(binding_region::start() as usize);
    for (place, word) in bytes.as_chunks().0.iter().enumerate() {
        // SAFETY: the region is memory of the emulated board, a page from a word's boundary on, longer than a record,
        // and no section of the program is placed in it. Nobody reads it meanwhile: there is one executor, and this
        // does not await.
        unsafe { start.add(place).write_volatile(u32::from_le_bytes(*word)) };
    }
}
