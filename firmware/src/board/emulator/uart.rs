//! The CMSDK UART. The transmitter is polled: in the emulator it is as fast as the reader outside.

use core::fmt;

use super::registers::Register;

const TX_FULL: u32 = 1;
pub(super) const RX_FULL: u32 = 1 << 1;
pub(super) const TX_ENABLE: u32 = 1;
pub(super) const RX_ENABLE: u32 = 1 << 1;
pub(super) const RX_INTERRUPT: u32 = 1 << 3;
/// Smallest divider that QEMU's model accepts; it ignores the rate otherwise.
const DIVIDER: u32 = 16;

/// A UART.
#[derive(Clone, Copy)]
pub struct Uart {
    pub(super) data: Register,
    pub(super) state: Register,
    pub(super) control: Register,
    pub(super) interrupt: Register,
    divider: Register,
}

impl Uart {
    /// The labels, and commands.
    pub const LABELS: Self = Self::at(0x4000_4000);
    /// HCI to the Bluetooth controller.
    pub const HCI: Self = Self::at(0x4000_5000);
    /// The pin levels.
    pub const PINS: Self = Self::at(0x4000_6000);

    const fn at(base: usize) -> Self {
        Self {
            data: Register::at(base),
            state: Register::at(base + 0x4),
            control: Register::at(base + 0x8),
            interrupt: Register::at(base + 0xc),
            divider: Register::at(base + 0x10),
        }
    }

    /// Enables the transmitter, and what `control` adds.
    pub fn start(self, control: u32) {
        self.divider.write(DIVIDER);
        self.control.write(TX_ENABLE | control);
    }

    /// The byte that was received, if there is one. The sender waits while none is taken.
    pub fn receive(self) -> Option<u8> {
        let is_full = self.state.read() & RX_FULL != 0;
        is_full.then(|| self.data.read().to_le_bytes()[0])
    }

    /// Whether there is no room for a byte to send.
    pub fn is_full(self) -> bool {
        self.state.read() & TX_FULL != 0
    }

    /// Sends, waiting for room.
    pub fn send(self, bytes: &[u8]) {
        for &byte in bytes {
            while self.is_full() {}
            self.data.write(byte.into());
        }
    }
}

impl fmt::Write for Uart {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.send(text.as_bytes());
        Ok(())
    }
}
