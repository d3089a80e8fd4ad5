//! Virtual time: it passes while the program waits, and while the scenario says that it computes.

use embassy_futures::yield_now;

use super::hardware::{self, Incident};
use super::person::Person;
use super::power;
use crate::reset_reason::ResetReason;

/// Microseconds of one turn of all tasks.
const TURN_US: u64 = 20;

/// Lets time pass with every turn of the executor, and the person act in it.
#[embassy_executor::task]
pub async fn run(mut person: Person) -> ! {
    loop {
        spend(TURN_US);
        person.act(hardware::now_us(), hardware::packets_sent());
        yield_now().await;
    }
}

/// The program computes for so long; no other task runs.
pub fn spend(us: u64) {
    match hardware::advance(us) {
        None => {}
        Some(Incident::End) => std::process::exit(0),
        Some(Incident::Reset) => power::reset(ResetReason::Watchdog),
    }
}
