//! The chip's flash. The processor halts while it is written, so the Bluetooth stack does that when the radio lets it.

use embedded_storage_async::nor_flash::NorFlash;

use crate::flash::{Flash, FlashFailed, PAGE_BYTES};

/// Flash as a Bluetooth stack gives it.
pub struct ChipFlash<F>(pub F);

impl<F: NorFlash> Flash for ChipFlash<F> {
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed> {
        let erased = self.0.erase(page, page + PAGE_BYTES).await;
        erased.map_err(|_| FlashFailed)
    }

    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed> {
        let written = self.0.write(address, words).await;
        written.map_err(|_| FlashFailed)
    }
}
