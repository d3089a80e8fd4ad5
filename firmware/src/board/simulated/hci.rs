//! HCI over a socket (Bluetooth Core, Vol 4, Part A), to a controller that another program simulates.

use std::io::{self, Read as _, Write as _};
use std::os::unix::net::UnixStream;

use bt_hci::controller::ExternalController;
use bt_hci_serial::SerialTransport;
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io::{ErrorKind, ErrorType};
use embedded_io_async::{Read, Write};

use super::hardware;
use crate::flash::{Flash, SharedFlash};
use crate::radio::{driver::SessionDriver, trouble};

/// The central's random static address.
const OWN_ADDRESS: [u8; 6] = [0x01, 0x02, 0x03, 0x04, 0x05, 0xc6];

/// Runs the Bluetooth host and the session until the controller fails.
pub async fn run(
    controller: &UnixStream,
    driver: &SessionDriver<'_>,
    flash: &SharedFlash<impl Flash>,
) {
    controller
        .set_nonblocking(true)
        .expect("a socket that is open");
    let transport =
        SerialTransport::<NoopRawMutex, _, _>::new(Socket(controller), Socket(controller));
    let controller: ExternalController<_, 10> = ExternalController::new(transport);
    trouble::run(controller, OWN_ADDRESS, driver, flash).await;
}

/// One direction of a socket that does not block.
struct Socket<'s>(&'s UnixStream);

/// Tries until the socket is ready. Other tasks run, and time passes, between two attempts.
async fn ready(mut attempt: impl FnMut() -> io::Result<usize>) -> Result<usize, ErrorKind> {
    loop {
        match attempt() {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => yield_now().await,
            done => return done.map_err(|_| ErrorKind::Other),
        }
    }
}

impl ErrorType for Socket<'_> {
    type Error = ErrorKind;
}

impl Read for Socket<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        let count = ready(|| self.0.read(buffer)).await?;
        hardware::heard();
        Ok(count)
    }
}

impl Write for Socket<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        ready(|| self.0.write(bytes)).await
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
