//! HCI over a UART (Bluetooth Core, Vol 4, Part A) to a controller outside the emulator.

use core::{
    convert::Infallible,
    sync::atomic::{AtomicU32, Ordering},
};

use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};
use embassy_time::Instant;
use embedded_io_async::{ErrorType, Read, Write};

use super::irq::Irq;
use super::uart::{RX_ENABLE, RX_FULL, RX_INTERRUPT, TX_ENABLE, Uart};

/// 60 notifications: more than `trouble` queues.
static RECEIVED: Pipe<CriticalSectionRawMutex, 2048> = Pipe::new();
/// Time at which the newest byte was received, in microseconds; wraps after 71 minutes.
static LAST_BYTE: AtomicU32 = AtomicU32::new(0);

/// Receives HCI packets.
pub struct FromController;
/// Sends HCI packets.
pub struct ToController;

/// Starts the UART.
pub fn start() -> (FromController, ToController) {
    Uart::HCI.start(RX_ENABLE | RX_INTERRUPT);
    Irq::HciReceive.unmask();
    (FromController, ToController)
}

/// Resets the controller and skips whatever it sent before.
///
/// The controller is not reset with this program, so it may be in the middle of a packet. Packets
/// are in sync again from the response to the reset on (Bluetooth Core, Vol 4, Part A, 4). If there is
/// none, the watchdog restarts the program and so repeats this.
pub async fn synchronize(from: &mut FromController, to: &mut ToController) {
    // A command packet with the opcode 0x0c03 and no parameters.
    let Ok(()) = to.write_all(&[0x01, 0x03, 0x0c, 0x00]).await;
    let mut newest = [0; 7];
    // The event "command complete": number of further commands, opcode, success.
    while !matches!(newest, [0x04, 0x0e, 0x04, _, 0x03, 0x0c, 0x00]) {
        newest.rotate_left(1);
        let Ok(_) = from.read(&mut newest[6..]).await;
    }
}

/// Time at which the newest byte was received, in microseconds.
pub fn last_byte() -> u32 {
    LAST_BYTE.load(Ordering::Relaxed)
}

/// The interrupt handler of the receiver.
pub fn on_receive() {
    let uart = Uart::HCI;
    uart.interrupt.write(RX_FULL);
    while uart.state.read() & RX_FULL != 0 {
        if RECEIVED.free_capacity() == 0 {
            // The byte stays in the UART and blocks the sender; `read` enables the interrupt again.
            uart.control.write(TX_ENABLE | RX_ENABLE);
            return;
        }
        let byte = uart.data.read().to_le_bytes()[0];
        let _ = RECEIVED.try_write(&[byte]);
        #[expect(clippy::cast_possible_truncation, reason = "wraps, as documented")]
        LAST_BYTE.store(Instant::now().as_micros() as u32, Ordering::Relaxed);
    }
}

impl ErrorType for FromController {
    type Error = Infallible;
}

impl Read for FromController {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let count = RECEIVED.read(buffer).await;
        critical_section::with(|_| {
            Uart::HCI
                .control
                .write(TX_ENABLE | RX_ENABLE | RX_INTERRUPT);
            on_receive();
        });
        Ok(count)
    }
}

impl ErrorType for ToController {
    type Error = Infallible;
}

impl Write for ToController {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Uart::HCI.send(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
