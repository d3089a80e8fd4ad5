//! Feeds the watchdog while every other task makes progress.

use embassy_time::Timer;

use crate::board::Watchdog;
use crate::messages::heartbeat;

#[embassy_executor::task]
pub async fn run(mut watchdog: Watchdog) -> ! {
    loop {
        if heartbeat::all_beat() {
            watchdog.feed();
        }
        Timer::after(heartbeat::PERIOD / 2).await;
    }
}
