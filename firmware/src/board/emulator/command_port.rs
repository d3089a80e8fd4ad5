//! UART0's receiver: commands.

use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};

use super::irq::Irq;
use super::uart::{RX_ENABLE, RX_FULL, RX_INTERRUPT, TX_ENABLE, Uart};
use crate::board::BytesLost;

/// Received bytes: as many as the receiver of a chip buffers.
static RECEIVED: Pipe<CriticalSectionRawMutex, 128> = Pipe::new();

/// Receives commands.
pub struct CommandPort(());

impl CommandPort {
    /// Enables the receiver, and the transmitter that has the same control register.
    pub fn start() -> Self {
        Uart::LABELS.start(RX_ENABLE | RX_INTERRUPT);
        Irq::CommandReceive.unmask();
        Self(())
    }

    /// Waits for bytes and takes some; gives the line that they came by and their number. None are lost: a sender outside the
    /// emulator waits while its bytes are not taken.
    pub async fn read(&mut self, buffer: &mut [u8]) -> (usize, Result<usize, BytesLost>) {
        let count = RECEIVED.read(buffer).await;
        critical_section::with(|_| {
            Uart::LABELS
                .control
                .write(TX_ENABLE | RX_ENABLE | RX_INTERRUPT);
            on_receive();
        });
        (0, Ok(count))
    }
}

/// The interrupt handler.
pub fn on_receive() {
    let uart = Uart::LABELS;
    uart.interrupt.write(RX_FULL);
    while uart.state.read() & RX_FULL != 0 {
        if RECEIVED.free_capacity() == 0 {
            // The byte stays in the UART and blocks the sender; `read` enables the interrupt again.
            uart.control.write(TX_ENABLE | RX_ENABLE);
            return;
        }
        let _ = RECEIVED.try_write(&[uart.data.read().to_le_bytes()[0]]);
    }
}
