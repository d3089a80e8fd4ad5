//! The state that pins and LEDs show. Only the newest counts, so it is not a queue.

use core::cell::Cell;

use embassy_sync::{
    blocking_mutex::{Mutex, raw::CriticalSectionRawMutex},
    signal::Signal,
};
use shared::stream::safe_state::{Cause, Status};
use shared::stream::strength::Percent;

#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PinState {
    /// Label and `valid`. Exactly one intent's pin is high: relax in the safe state.
    pub status: Status,
    pub strength: Percent,
    pub armband: bool,
    /// Whether the LED of alignment and calibration is lit.
    pub alignment_led: bool,
}

impl PinState {
    /// State after a start and after a panic.
    pub const SAFE: Self = Self {
        status: Status::Safe(Cause::Boot),
        strength: Percent::ZERO,
        armband: false,
        alignment_led: false,
    };
}

static STATE: Mutex<CriticalSectionRawMutex, Cell<PinState>> =
    Mutex::new(Cell::new(PinState::SAFE));
/// The state that was set last.
static SHOWN: Mutex<CriticalSectionRawMutex, Cell<PinState>> =
    Mutex::new(Cell::new(PinState::SAFE));
static CHANGED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Sets label, `valid`, and the strength of the label.
pub fn set_status(status: Status, strength: Percent) {
    update(|state| (state.status, state.strength) = (status, strength));
}

pub fn set_armband(streams: bool) {
    update(|state| state.armband = streams);
}

/// Sets whether the LED of alignment and calibration is lit.
pub fn set_alignment_led(lit: bool) {
    update(|state| state.alignment_led = lit);
}

fn update(change: impl FnOnce(&mut PinState)) {
    STATE.lock(|cell| {
        let before = cell.get();
        let mut state = before;
        change(&mut state);
        if state != before {
            cell.set(state);
            CHANGED.signal(());
        }
    });
}

pub fn current() -> PinState {
    STATE.lock(Cell::get)
}

/// Notes that the pins show this state.
pub fn set_shown(state: PinState) {
    SHOWN.lock(|cell| cell.set(state));
}

/// Whether the pins show the newest label and `valid`. The strength, set with them, changes with every patch and may be a
/// packet late; LEDs do not count: nothing acts on them.
pub fn is_shown() -> bool {
    SHOWN.lock(Cell::get).status == current().status
}

/// Waits until the state changed since the last wait.
pub async fn changed() {
    CHANGED.wait().await;
}
