//! The whole device without hardware: its program in an emulated Cortex-M4F, a virtual Bluetooth
//! controller on its HCI UART, and a virtual armband on the other side of the radio link.
//!
//! ```text
//! Armband (Python) -- virtual link -- controller == HCI, unix socket == Machine (QEMU)
//!     log of events                                     UART0: lines   UART2: pins
//! ```
//!
//! The processes of a run write into one folder. A test reads it, waits with a timeout, and prints the
//! tails of all files when it fails. Dropping a [`Run`] kills both processes.

#[cfg(target_os = "linux")]
mod bridge;
mod check;
mod machine;
mod oracle;
mod process;
mod run;

#[cfg(target_os = "linux")]
pub use bridge::{Bridge, terminal};
pub use machine::{MODEL_REGION, Machine};
pub use oracle::{Input, expected_lines};
pub use run::Run;

use std::path::PathBuf;
use std::sync::{Condvar, Mutex, OnceLock, PoisonError};

use shared::units::Sample;
use xtask::firmware::{self, Image};
use xtask::{emulator, qemu, toolchain};

/// Runs that may exist at a time. A board whose clock is slowed down keeps a tenth of a core busy; timing means nothing in
/// an emulator that has to wait for one.
const PLACES: usize = 2;
static FREE: Mutex<usize> = Mutex::new(PLACES);
static FREED: Condvar = Condvar::new();

/// One of the [`PLACES`].
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

/// A Python that can run the armband.
pub struct Python {
    /// The interpreter.
    pub path: PathBuf,
    _place: Place,
}

/// An emulated board and its program.
pub struct Board {
    image: PathBuf,
    _place: Place,
}

/// A board and an armband.
pub struct Bench {
    board: Board,
    python: PathBuf,
}

/// One run: what the armband streams, how it misbehaves, and how fast.
///
/// To the guest the armband streams at `pace * time_scale` times 200 Hz. With a large scale a pause of
/// a busy host is short on the guest's clock, so that its timeouts do not disturb the test.
#[derive(Clone, Debug)]
pub struct Scenario<'s> {
    /// The model's flash region from its start; the rest is erased.
    pub model: &'s [u8],
    /// Samples that the armband streams.
    pub samples: &'s [Sample],
    /// Page of the bound armband from its start; a reset restores it. Without it the page is empty at first.
    pub page: Option<Vec<u8>>,
    /// Factor by which the guest's clock runs slower than real time.
    pub time_scale: u32,
    /// Factor by which the armband streams faster than 200 Hz of real time.
    pub pace: f64,
    /// Steps of misbehaviour, as `tests/armband/misbehaviour.py` describes them.
    pub script: serde_json::Value,
    /// More arguments of the armband.
    pub arguments: Vec<String>,
}

/// The armband's Python; without it, reports the test `name` as skipped.
#[must_use]
pub fn python(name: &str) -> Option<Python> {
    let place = Place::wait();
    Some(Python {
        path: or_skip(name, emulator::python())?,
        _place: place,
    })
}

/// A board and an armband; if something they need is missing, reports the test `name` as skipped.
///
/// # Panics
/// As [`board`].
#[must_use]
pub fn bench(name: &str) -> Option<Bench> {
    let python = or_skip(name, emulator::python())?;
    Some(Bench {
        board: board(name)?,
        python,
    })
}

/// A board without an armband; if something it needs is missing, reports the test `name` as skipped.
///
/// # Panics
/// If the image does not build: that is no reason to skip.
#[must_use]
pub fn board(name: &str) -> Option<Board> {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    let toolchain = or_skip(name, toolchain::find(false))?;
    or_skip(name, qemu::find())?;
    let place = Place::wait();
    let image = IMAGE.get_or_init(|| {
        firmware::build_image(&toolchain, Image::Emulator, false, false)
            .unwrap_or_else(|error| panic!("the emulator's image: {error:#}"))
    });
    Some(Board {
        image: image.clone(),
        _place: place,
    })
}

fn or_skip<T>(name: &str, found: anyhow::Result<T>) -> Option<T> {
    found
        .map_err(|reason| crate::skip(name, &format!("{reason:#}").replace('\n', " ")))
        .ok()
}

impl Bench {
    /// Starts armband and machine.
    ///
    /// # Errors
    /// When one of them does not start.
    pub fn start(&self, scenario: &Scenario<'_>) -> anyhow::Result<Run> {
        Run::start(self, scenario)
    }
}

impl Board {
    /// Starts the machine with neither model nor Bluetooth controller: memory in the place of flash that a reset keeps.
    ///
    /// # Errors
    /// When it does not start.
    pub fn start_empty(&self) -> anyhow::Result<Run> {
        Run::start_without_armband(self)
    }
}
