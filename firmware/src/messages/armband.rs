//! What the radio knows of the armband. Only the newest counts, so it is no queue.

use core::cell::Cell;

use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use shared::myo::{Address, Counters, FirmwareVersion, MyoSession, Phase};

/// What is known of the armband.
#[derive(Clone, Copy, Default)]
pub struct Armband {
    /// The one that is connected.
    pub address: Option<Address>,
    /// Its firmware.
    pub firmware: Option<FirmwareVersion>,
    /// Its battery, percent.
    pub battery: Option<u8>,
}

/// The armband, and the counts of all sessions since the start; none before the first event.
static KNOWN: Mutex<CriticalSectionRawMutex, Cell<Option<(Armband, Counters)>>> =
    Mutex::new(Cell::new(None));

/// Keeps what a session knows.
pub fn set(session: &MyoSession) {
    let is_connected = matches!(session.phase(), Phase::SettingUp | Phase::Streaming);
    let connected = is_connected.then_some(session);
    let armband = Armband {
        address: connected.and_then(MyoSession::armband),
        firmware: connected.and_then(MyoSession::firmware),
        battery: connected.and_then(MyoSession::battery),
    };
    KNOWN.lock(|cell| cell.set(Some((armband, session.counters()))));
}

/// What is known of the armband now.
pub fn current() -> Armband {
    KNOWN.lock(Cell::get).unwrap_or_default().0
}

/// Counts of all sessions since the start.
pub fn counters() -> Counters {
    KNOWN.lock(Cell::get).unwrap_or_default().1
}
