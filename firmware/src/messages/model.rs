//! Which model is in use.

use core::cell::Cell;

use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};

static IN_USE: Mutex<CriticalSectionRawMutex, Cell<Option<u32>>> = Mutex::new(Cell::new(None));

/// The CRC-32 of its file; none while there is none.
pub fn current() -> Option<u32> {
    IN_USE.lock(Cell::get)
}

/// This one is in use from now on, or none.
pub fn set(checksum: Option<u32>) {
    IN_USE.lock(|cell| cell.set(checksum));
}
