//! The chip's flash. The processor halts while it is written, so the Bluetooth stack does that when the radio lets it.

use embedded_storage_async::nor_flash::NorFlash;

use crate::flash::{Flash, FlashFailed, PAGE_BYTES};

/// Attempts of an operation: a stack that finds no time for it beside the radio gives up, and it has not begun then.
const ATTEMPTS: usize = 4;

pub struct ChipFlash<F>(pub F);

impl<F: NorFlash> Flash for ChipFlash<F> {
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed> {
        attempted(async || self.0.erase(page, page + PAGE_BYTES).await).await
    }

    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed> {
        attempted(async || self.0.write(address, words).await).await
    }
}

/// Attempts an operation until it succeeds.
async fn attempted<E>(
    mut operation: impl AsyncFnMut() -> Result<(), E>,
) -> Result<(), FlashFailed> {
    for _ in 0..ATTEMPTS {
        if operation().await.is_ok() {
            return Ok(());
        }
    }
    Err(FlashFailed)
}
