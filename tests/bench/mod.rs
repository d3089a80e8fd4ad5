//! The board's program on the PC beside another maker's Bluetooth controller and armband, in the PC's time.
//!
//! ```text
//! Armband (Python) -- virtual link -- controller == HCI, unix socket == the simulated board
//!     log of events                                       UART: standard input, a file   pins: a file
//! ```
//!
//! The processes of a run write into one folder. A test reads it, waits with a timeout, and prints the
//! tails of all files when it fails. Dropping a [`Run`] kills both processes.

#[cfg(target_os = "linux")]
mod bridge;
mod process;
mod run;

#[cfg(target_os = "linux")]
pub use bridge::{Bridge, terminal};
pub use run::Run;

use std::path::PathBuf;
use std::sync::{Condvar, Mutex, PoisonError};

use shared::units::Sample;
use xtask::emulator;

/// Runs that may exist at a time. Timing means nothing on a PC that has to wait for a core.
const PLACES: usize = 2;
static FREE: Mutex<usize> = Mutex::new(PLACES);
static FREED: Condvar = Condvar::new();

struct Place(());

impl Place {
    fn wait() -> Self {
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
        let free = FREED.wait_while(free, |free| *free == 0);
        *free.unwrap_or_else(PoisonError::into_inner) -= 1;
        Self(())
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        *FREE.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        FREED.notify_one();
    }
}

/// Contents and surroundings of a board: what it holds, what the armband streams, how it misbehaves, and how fast.
///
/// To the board the armband streams at `pace * slowed` times 200 Hz. A pause of a busy PC is shorter on a slowed clock, so
/// that the board's timeouts do not disturb the test.
#[derive(Clone, Debug)]
pub struct Scenario<'s> {
    /// The model's flash region from its start; the rest is erased.
    pub model: &'s [u8],
    pub samples: &'s [Sample],
    /// Page of the bound armband from its start; erased where it ends.
    pub page: Vec<u8>,
    /// Factor by which the board's clock runs slower than the PC's.
    pub slowed: u32,
    /// Factor by which the armband streams faster than 200 Hz of the PC's time.
    pub pace: f64,
    /// Steps of misbehaviour, as `tests/armband/misbehaviour.py` describes them.
    pub script: serde_json::Value,
    pub arguments: Vec<String>,
}

/// Python that can run the armband, and a place to do it.
pub struct Python {
    pub path: PathBuf,
    place: Place,
}

/// The armband's Python; without it, reports the test as skipped.
pub fn python() -> Option<Python> {
    let skip = |reason| crate::skip(&format!("{reason:#}"));
    Some(Python {
        path: emulator::python().map_err(skip).ok()?,
        place: Place::wait(),
    })
}
