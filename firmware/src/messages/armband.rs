//! State of the armband, from the radio. Only the newest counts, so it is not a queue.

use core::cell::Cell;

use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use shared::myo::{Address, Counters, FirmwareVersion, MyoSession, Phase};

#[derive(Clone, Copy, Default)]
pub struct Armband {
    pub address: Option<Address>,
    pub firmware: Option<FirmwareVersion>,
    /// Battery charge, percent.
    pub battery: Option<u8>,
}

/// The armband, and the counts of all sessions since the start; none before the first event.
static KNOWN: Mutex<CriticalSectionRawMutex, Cell<Option<(Armband, Counters)>>> =
    Mutex::new(Cell::new(None));

/// Keeps the state of a session.
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

/// The newest state of the armband.
pub fn current() -> Armband {
    KNOWN.lock(Cell::get).unwrap_or_default().0
}

/// Counts of all sessions since the start.
pub fn counters() -> Counters {
    KNOWN.lock(Cell::get).unwrap_or_default().1
}
