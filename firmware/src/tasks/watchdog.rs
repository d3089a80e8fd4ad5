//! Feeds the watchdog for as long as every other task comes round.

use core::sync::atomic::{AtomicBool, Ordering};

use embassy_time::{Duration, Timer};

use crate::board::Watchdog;
use crate::settings::WATCHDOG_MS;

/// The longest that a task may wait for anything without saying that it is alive.
pub const ROUND: Duration = Duration::from_millis(WATCHDOG_MS as u64 / 4);

/// Alive while the session hears of time.
pub static RADIO: Sign = Sign(AtomicBool::new(false));
/// Alive while packets are taken.
pub static INFERENCE: Sign = Sign(AtomicBool::new(false));
/// Alive while lines are taken.
pub static OUTPUT: Sign = Sign(AtomicBool::new(false));

/// One task's sign of life.
pub struct Sign(AtomicBool);

impl Sign {
    /// The task came round.
    pub fn alive(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it did since this was last asked.
    fn seen(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs for ever.
#[embassy_executor::task]
pub async fn run(mut watchdog: Watchdog) -> ! {
    const SIGNS: [&Sign; 3] = [&RADIO, &INFERENCE, &OUTPUT];
    loop {
        if SIGNS.iter().all(|sign| sign.seen()) {
            for sign in SIGNS {
                sign.0.store(false, Ordering::Relaxed);
            }
            watchdog.feed();
        }
        Timer::after(ROUND / 2).await;
    }
}
