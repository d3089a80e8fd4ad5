//! Heartbeats, one per task: the watchdog is fed only while all of them beat.

use core::sync::atomic::{AtomicBool, Ordering};

use embassy_time::Duration;

use crate::settings::WATCHDOG_MS;

/// The longest time that a task may wait without a beat.
pub const PERIOD: Duration = Duration::from_millis(WATCHDOG_MS as u64 / 4);

/// Beats while the session shows [progress](shared::myo::RadioProgress).
pub static RADIO: Heartbeat = Heartbeat::new();
/// Beats while packets pass the pipeline, or no packet waits.
pub static INFERENCE: Heartbeat = Heartbeat::new();
/// Beats while the UART takes lines, or no line waits.
pub static OUTPUT: Heartbeat = Heartbeat::new();

/// Evidence that one task makes progress.
pub struct Heartbeat(AtomicBool);

impl Heartbeat {
    const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    /// The task made progress.
    pub fn beat(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Whether every task has beaten since this last returned true.
pub fn all_beat() -> bool {
    let all: [&Heartbeat; 3] = [&RADIO, &INFERENCE, &OUTPUT];
    let beaten = all.iter().all(|one| one.0.load(Ordering::Relaxed));
    if beaten {
        for one in all {
            one.0.store(false, Ordering::Relaxed);
        }
    }
    beaten
}
