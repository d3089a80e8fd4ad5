//! The regions of flash that the program writes: memory that a reset keeps. The program writes it as flash is written, word by
//! word after an erasure, from ones to zeros.

use core::ptr;

use embassy_time::Timer;

use crate::flash::{Flash, FlashFailed, PAGE_BYTES};

/// Microseconds of an erasure and of a word (nRF52840 product specification, NVMC), in which other tasks run.
const ERASE_US: u64 = 85_000;
const WORD_US: u64 = 41;

/// Memory in the place of flash.
pub struct Memory;

impl Flash for Memory {
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed> {
        Timer::after_micros(ERASE_US).await;
        (page..page + PAGE_BYTES)
            .step_by(4)
            .for_each(|address| set(address, |_| u32::MAX));
        Ok(())
    }

    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed> {
        Timer::after_micros(WORD_US * words.len() as u64 / 4).await;
        for (address, word) in (address..).step_by(4).zip(words.as_chunks().0) {
            set(address, |before| before & u32::from_le_bytes(*word));
        }
        Ok(())
    }
}

/// Changes a word.
#[expect(unsafe_code, reason = "the regions are no Rust objects")]
fn set(address: u32, change: impl FnOnce(u32) -> u32) {
    let word = ptr::with_exposed_provenance_mut::<u32>(address as usize);
    // SAFETY: callers of `Flash` give addresses of regions, which are memory of the emulated board, and no section of the
    // program is placed in them; they begin at a word. Nobody reads them meanwhile: there is one executor, and this does
    // not await; what holds a slice of them was given up before (`installation`).
    unsafe { word.write_volatile(change(word.read_volatile())) };
}
