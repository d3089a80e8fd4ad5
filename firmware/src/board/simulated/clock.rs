//! Virtual time, which passes while the program waits, and while the scenario says that it computes; or time that follows the
//! PC's.

use std::io::Read as _;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use embassy_futures::yield_now;

use super::hardware::{self, Incident};
use super::person::ScenarioPerson;
use super::power;
use crate::reset_reason::ResetReason;

const TURN_US: u64 = 20;
/// Pause after one turn that follows the PC.
const PAUSE: Duration = Duration::from_micros(200);
/// Longest time of one turn that follows the PC: whatever else a busy PC does delays the board's time as well.
const MOST_US: u64 = 1000;

/// Lets time pass with every turn of the executor, and the person act in it. With `slowed` it passes by this factor slower
/// than the PC's, and the person sends what the program reads from its standard input.
#[embassy_executor::task]
pub async fn run(mut person: ScenarioPerson, slowed: Option<u32>) -> ! {
    let mut pace = slowed.map(|factor| (factor, Instant::now(), typed()));
    loop {
        match &mut pace {
            None => spend(TURN_US),
            Some((factor, last, typed)) => {
                thread::sleep(PAUSE);
                let us = last.elapsed().as_micros() as u64 / u64::from(*factor);
                *last += Duration::from_micros(us) * *factor;
                spend(us.min(MOST_US));
                person.send(typed.try_iter());
            }
        }
        person.act(hardware::now_us(), hardware::packets_sent());
        yield_now().await;
    }
}

/// Bytes of standard input, as they come.
fn typed() -> mpsc::Receiver<u8> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let bytes = std::io::stdin().lock().bytes();
        bytes
            .map_while(Result::ok)
            .try_for_each(|byte| sender.send(byte))
    });
    receiver
}

/// The program computes for so long; no other task runs.
pub fn spend(us: u64) {
    match hardware::advance(us) {
        None => {}
        Some(Incident::End) => std::process::exit(0),
        Some(Incident::Reset) => power::reset(ResetReason::Watchdog),
    }
}
