//! HCI over a UART (Bluetooth Core, Vol 4, Part A): bytes to and from a controller elsewhere.

use core::{
    convert::Infallible,
    sync::atomic::{AtomicU32, Ordering},
};

use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};
use embassy_time::Instant;
use embedded_io_async::{ErrorType, Read, Write};

use super::{interrupts::Line, uart::Uart};

const RX_FULL: u32 = 1 << 1;
const RX_ENABLE: u32 = 1 << 1;
const RX_INTERRUPT: u32 = 1 << 3;
const TX_ENABLE: u32 = 1;

/// 60 notifications: as many as trouble's own queue and a burst beside.
static RECEIVED: Pipe<CriticalSectionRawMutex, 2048> = Pipe::new();
/// When the newest byte came, in microseconds; wraps after 71 minutes.
static LAST_BYTE: AtomicU32 = AtomicU32::new(0);

/// The two directions of the line.
pub struct FromController;
/// See [`FromController`].
pub struct ToController;

/// Starts the line.
pub fn start() -> (FromController, ToController) {
    Uart::HCI.start(RX_ENABLE | RX_INTERRUPT);
    Line::HciReceive.unmask();
    (FromController, ToController)
}

/// Resets the controller and passes over whatever it sent before.
///
/// It does not start anew with this program, and may be in the middle of a packet. Packets begin
/// again with the answer to a reset (Bluetooth Core, Vol 4, Part A, 4). Where none comes, the
/// watchdog starts all of this once more.
pub async fn synchronize(from: &mut FromController, to: &mut ToController) {
    // A command packet with the opcode 0x0c03 and no parameters.
    let Ok(()) = to.write_all(&[0x01, 0x03, 0x0c, 0x00]).await;
    let mut newest = [0; 7];
    // An event packet "command complete": how many commands may follow, the opcode, success.
    while !matches!(newest, [0x04, 0x0e, 0x04, _, 0x03, 0x0c, 0x00]) {
        newest.rotate_left(1);
        let Ok(_) = from.read(&mut newest[6..]).await;
    }
}

/// When the newest byte came, in microseconds.
pub fn last_byte() -> u32 {
    LAST_BYTE.load(Ordering::Relaxed)
}

/// The receive interrupt.
pub fn received() {
    let uart = Uart::HCI;
    uart.interrupt.write(RX_FULL);
    while uart.state.read() & RX_FULL != 0 {
        if RECEIVED.free_capacity() == 0 {
            // The byte stays where it is and holds up the sender; the next read goes on.
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
            received();
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
