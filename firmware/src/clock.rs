//! The time as `shared` counts it.

use embassy_time::Instant;
use shared::units::Millis;

pub fn now() -> Millis {
    #[expect(clippy::cast_possible_truncation, reason = "wraps, as `Millis` does")]
    Millis(Instant::now().as_millis() as u32)
}

/// Lets one test at a time move the virtual time, which all of them have in common.
#[cfg(test)]
pub fn alone() -> std::sync::MutexGuard<'static, ()> {
    use std::sync::{Mutex, PoisonError};

    static TIME: Mutex<()> = Mutex::new(());
    TIME.lock().unwrap_or_else(PoisonError::into_inner)
}
