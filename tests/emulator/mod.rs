//! The whole device without hardware: its program in an emulated Cortex-M4F, a virtual Bluetooth
//! controller on its HCI UART, and a virtual armband on the other side of the air.
//!
//! ```text
//! Armband (Python) -- virtual air -- controller == HCI, unix socket == Machine (QEMU)
//!     log: what it did                                 UART0: lines   UART2: pins
//! ```
//!
//! Every process writes into one folder per run; a test reads there, waits with an end to its
//! patience, and shows the tails of all files when it gives up. Dropping a [`Run`] ends both.

mod machine;
mod model_damage;
mod oracle;
mod pins;
mod process;
mod run;

pub use machine::{Fault, MODEL_REGION, Machine, Straps};
pub use model_damage::{Damage, damages};
pub use oracle::{Input, expected_lines};
pub use pins::Pins;
pub use run::Run;

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use shared::units::Sample;
use xtask::firmware::{self, Image};
use xtask::{emulator, qemu, toolchain};

/// While it lives there is no other: each run keeps a core busy, and a starved emulator tests
/// nothing.
struct Alone(#[expect(dead_code, reason = "held, not read")] MutexGuard<'static, ()>);

impl Alone {
    fn wait() -> Self {
        static LABELS_ONLY: Mutex<()> = Mutex::new(());
        Self(LABELS_ONLY.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A Python that can run the armband.
pub struct Python {
    /// The interpreter.
    pub path: PathBuf,
    _alone: Alone,
}

/// An emulated board and its program.
pub struct Board {
    image: PathBuf,
    _alone: Alone,
}

/// A board and an armband.
pub struct Bench {
    board: Board,
    python: PathBuf,
}

/// One run: what the armband streams and how it misbehaves, and how fast all of it goes.
///
/// The guest sees `pace * time_scale` times real time. With a large scale a pause of a busy
/// machine is short for the guest, so that what it times cannot disturb the test.
#[derive(Clone, Debug)]
pub struct Scene<'s> {
    /// The model's flash region from its start; the rest is erased.
    pub model: &'s [u8],
    /// What the armband streams.
    pub samples: &'s [Sample],
    /// How many times slower than the wall the guest's clock runs.
    pub time_scale: u32,
    /// How many times faster than 200 Hz of the wall the armband streams.
    pub pace: f64,
    /// What the board itself does wrong.
    pub fault: Option<Fault>,
    /// Steps of misbehaviour, as `tests/armband/misbehaviour.py` describes them.
    pub script: serde_json::Value,
    /// More arguments of the armband.
    pub arguments: Vec<String>,
}

/// The armband's Python; without it, books the test `name` as skipped.
#[must_use]
pub fn python(name: &str) -> Option<Python> {
    let alone = Alone::wait();
    Some(Python {
        path: or_skip(name, emulator::python())?,
        _alone: alone,
    })
}

/// A board and an armband; without what they need, books the test `name` as skipped.
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

/// A board by itself; without what it needs, books the test `name` as skipped.
///
/// # Panics
/// Where the image does not build: that is no reason to skip.
#[must_use]
pub fn board(name: &str) -> Option<Board> {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    let toolchain = or_skip(name, toolchain::find(false))?;
    or_skip(name, qemu::find())?;
    let alone = Alone::wait();
    let image = IMAGE.get_or_init(|| {
        firmware::build_image(&toolchain, Image::Emulator, false, false)
            .unwrap_or_else(|error| panic!("the emulator's image: {error:#}"))
    });
    Some(Board {
        image: image.clone(),
        _alone: alone,
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
    /// Where one of them does not start.
    pub fn start(&self, scene: &Scene<'_>) -> anyhow::Result<Run> {
        Run::start(self, scene)
    }
}

impl Board {
    /// Starts the machine, with a model and nobody to talk to.
    ///
    /// # Errors
    /// Where it does not start.
    pub fn start_alone(&self, model: &[u8]) -> anyhow::Result<Run> {
        Run::start_alone(self, model)
    }
}
