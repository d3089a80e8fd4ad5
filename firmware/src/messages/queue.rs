//! A bounded queue between two tasks. Its writer never waits.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_sync::{
    blocking_mutex::raw::CriticalSectionRawMutex,
    channel::{Channel, TrySendError},
};

/// Holds `N` entries; one more drops the oldest, which is counted.
pub struct Queue<T, const N: usize> {
    entries: Channel<CriticalSectionRawMutex, T, N>,
    dropped: AtomicU32,
}

impl<T, const N: usize> Queue<T, N> {
    pub const fn new() -> Self {
        Self {
            entries: Channel::new(),
            dropped: AtomicU32::new(0),
        }
    }

    pub fn push(&self, entry: T) {
        let mut entry = entry;
        while let Err(TrySendError::Full(rejected)) = self.entries.try_send(entry) {
            entry = rejected;
            if self.entries.try_receive().is_ok() {
                self.dropped.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    pub async fn receive(&self) -> T {
        self.entries.receive().await
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Entries dropped since the start; wraps.
    pub fn dropped(&self) -> u32 {
        self.dropped.load(Ordering::Relaxed)
    }
}
