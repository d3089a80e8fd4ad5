//! The wearer's calibration: how far it is, on the line and at the LED, and the way of a learnt head to flash.

use core::cell::Cell;

use embassy_sync::{
    blocking_mutex::{Mutex, raw::CriticalSectionRawMutex},
    signal::Signal,
};
use shared::calibration::{Memory, RecordError, Shown};
use shared::intent::Intent;
use shared::uart_line::answer::Answer;
use shared::uart_line::calibration::{CalibrationReport, CalibrationState};
use shared::units::Millis;

use super::uart::{self, UartMessage};
use crate::clock::now;

/// Milliseconds for which the LED blinks once a learnt head is in use.
const SUCCESS_MS: u32 = 3000;

/// The newest report, and when it was made.
static REPORT: Mutex<CriticalSectionRawMutex, Cell<(CalibrationReport, Millis)>> =
    Mutex::new(Cell::new((
        CalibrationReport::of(CalibrationState::Idle, None),
        Millis(0),
    )));

static IN_USE: Mutex<CriticalSectionRawMutex, Cell<Result<(), RecordError>>> =
    Mutex::new(Cell::new(Err(RecordError::Missing)));

/// Record that is to be in flash: that of a learnt head, or none. The inference has given up the model.
pub struct Keep {
    pub learnt: Option<&'static mut Memory>,
    pub model: u32,
}

/// From the inference to the installation.
pub static KEEP: Signal<CriticalSectionRawMutex, Keep> = Signal::new();
/// Memory on its way back to the inference.
pub static RETURNED: Signal<CriticalSectionRawMutex, &'static mut Memory> = Signal::new();

/// Notes how far a calibration is, and says it.
pub fn report(report: CalibrationReport) {
    REPORT.lock(|cell| cell.set((report, now())));
    uart::enqueue(UartMessage::Calibration(report));
}

pub fn current() -> CalibrationReport {
    REPORT.lock(Cell::get).0
}

/// Whether the LED is lit that leads the wearer: dark for rest, lit for a gesture, as `blink` for other movement, while flash is
/// written and for a while after that, if a learnt head is in use. `None` while there is nothing to show.
pub fn led(blink: bool) -> Option<bool> {
    use CalibrationState::{Done, Judging, Keeping, Teaching};
    let (report, at) = REPORT.lock(Cell::get);
    match (report.state, report.cue) {
        (Teaching | Judging, Some(Shown::Intent(cue))) => Some(cue != Intent::Relax),
        (Teaching | Judging | Keeping, _) => Some(blink),
        (Done, _) if now().elapsed_since(at) < SUCCESS_MS => Some(blink),
        _ => None,
    }
}

pub fn is_in_use() -> bool {
    IN_USE.lock(Cell::get).is_ok()
}

/// Sets whether a calibration is in use from now on, or why not.
pub fn set_in_use(in_use: Result<(), RecordError>) {
    IN_USE.lock(|cell| cell.set(in_use));
}

/// Says why the page is not used, unless it holds nothing.
pub fn say_if_refused() {
    match IN_USE.lock(Cell::get) {
        Ok(()) | Err(RecordError::Missing) => {}
        Err(error) => uart::enqueue(UartMessage::CalibrationRefused(error)),
    }
}

/// The answer to a command about it.
pub fn answer() -> Answer<'static> {
    Answer::Calibration(current(), is_in_use())
}
