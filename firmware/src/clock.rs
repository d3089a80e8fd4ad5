//! The time as `shared` counts it.

use embassy_time::Instant;
use shared::units::Millis;

/// Milliseconds since the start.
pub fn now() -> Millis {
    #[expect(clippy::cast_possible_truncation, reason = "wraps, as `Millis` does")]
    Millis(Instant::now().as_millis() as u32)
}
