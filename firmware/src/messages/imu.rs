//! Movement of the armband on its way to a USB host, while somebody there has asked for it. A UART has no room for it.

use core::fmt::Write as _;
use core::sync::atomic::{AtomicBool, Ordering};

use shared::uart_line::imu::ImuReport;

use super::usb::LINES;

static WANTED: AtomicBool = AtomicBool::new(false);

/// Sets whether movement is written from now on.
pub fn switch(on: bool) {
    WANTED.store(on, Ordering::Relaxed);
}

pub fn is_wanted() -> bool {
    WANTED.load(Ordering::Relaxed)
}

/// Adds a line beside those that the UART has, too.
pub fn send(report: ImuReport) {
    let mut line = heapless::String::<64>::new();
    if write!(line, "{report}").is_ok() {
        LINES.push(line.as_bytes());
    }
}
