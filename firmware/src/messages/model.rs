//! The model in use.

use core::cell::Cell;

use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};

static IN_USE: Mutex<CriticalSectionRawMutex, Cell<Option<u32>>> = Mutex::new(Cell::new(None));

/// CRC-32 of the model's file; none without a model.
pub fn current() -> Option<u32> {
    IN_USE.lock(Cell::get)
}

/// Sets the model that is in use from now on.
pub fn set(checksum: Option<u32>) {
    IN_USE.lock(|cell| cell.set(checksum));
}
