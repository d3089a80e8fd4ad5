//! Outputs to the computer: their settings, and the state that says which one is pressed. Only the newest counts.

use core::cell::Cell;

use embassy_sync::{
    blocking_mutex::{Mutex, raw::CriticalSectionRawMutex},
    signal::Signal,
};
use shared::hid::{Output, Settings};
use shared::stream::strength::Percent;

use super::pin_state::PinState;

static SETTINGS: Mutex<CriticalSectionRawMutex, Cell<Settings>> =
    Mutex::new(Cell::new(Settings::OFF));
static SHOWN: Mutex<CriticalSectionRawMutex, Cell<PinState>> =
    Mutex::new(Cell::new(PinState::SAFE));
static CHANGED: Signal<CriticalSectionRawMutex, ()> = Signal::new();
static SET: Signal<CriticalSectionRawMutex, ()> = Signal::new();

pub fn settings() -> Settings {
    SETTINGS.lock(Cell::get)
}

pub fn set(settings: Settings) {
    SETTINGS.lock(|cell| cell.set(settings));
    SET.signal(());
    wake();
}

/// Takes over what the pins show from now on.
pub fn show(state: PinState) {
    SHOWN.lock(|cell| cell.set(state));
    wake();
}

/// Wakes the task that sends reports.
pub fn wake() {
    CHANGED.signal(());
}

/// Output that is pressed, and the strength.
pub fn wanted() -> Option<(Output, Percent)> {
    let shown = SHOWN.lock(Cell::get);
    let output = settings().output(shown.status)?;
    Some((output, shown.strength))
}

/// Waits until the output, its strength or the settings may have changed.
pub async fn changed() {
    CHANGED.wait().await;
}

/// Waits until the computer is to see other devices than these.
pub async fn devices_change(seen: [bool; 3]) {
    while settings().devices() == seen {
        SET.wait().await;
    }
}
