//! Measures the board's own battery, and says when it is low.

use embassy_time::{Duration, Timer};

use crate::board::Battery;
use crate::messages::{
    battery::{self, Low},
    uart::{self, UartMessage},
};

const PERIOD: Duration = Duration::from_secs(10);

#[embassy_executor::task]
pub async fn run(mut battery: Battery) -> ! {
    let mut low = Low::default();
    loop {
        let charge = battery::charge(battery.millivolts().await);
        battery::set(charge);
        if low.begins(charge) {
            uart::enqueue(UartMessage::BoardBattery(charge));
        }
        Timer::after(PERIOD).await;
    }
}
