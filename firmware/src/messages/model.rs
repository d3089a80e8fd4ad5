//! The model in use.

use core::cell::Cell;

use embassy_sync::{
    blocking_mutex::{Mutex, raw::CriticalSectionRawMutex},
    signal::Signal,
};

static IN_USE: Mutex<CriticalSectionRawMutex, Cell<Option<u32>>> = Mutex::new(Cell::new(None));

static CHANGED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// CRC-32 of the model's file; none without a model.
pub fn current() -> Option<u32> {
    IN_USE.lock(Cell::get)
}

/// Sets the model that is in use from now on.
pub fn set(checksum: Option<u32>) {
    IN_USE.lock(|cell| cell.set(checksum));
    CHANGED.signal(());
}

/// Waits until a model is in use (`is_there`), or no model is. To be called by one task alone.
pub async fn until(is_there: bool) {
    while current().is_some() != is_there {
        CHANGED.wait().await;
    }
}
