//! The button: the emulated board has none that the outside could press, so UART2 receives the level of its pin.

use super::uart::{RX_ENABLE, Uart};

/// The level while the button is down, as of a pin that the button connects to ground.
const LOW: u8 = b'0';

/// The button.
pub struct Button {
    is_down: bool,
}

impl Button {
    /// Enables UART2. The button is up.
    pub fn start() -> Self {
        Uart::PINS.start(RX_ENABLE);
        Self { is_down: false }
    }

    /// Whether it is down at this moment.
    pub fn is_down(&mut self) -> bool {
        if let Some(level) = Uart::PINS.receive() {
            self.is_down = level == LOW;
        }
        self.is_down
    }
}
