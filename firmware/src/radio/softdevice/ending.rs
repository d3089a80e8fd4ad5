//! The end of a connection, without the library's own disconnection.
//!
//! nrf-softdevice 0.1 unwraps the answer of `sd_ble_gap_disconnect` in `Connection::disconnect`, and again when the last
//! [`Connection`] of a link is dropped that the library believes to be up. A link that ends by itself in that moment would
//! restart the board. So nobody here calls the one, and a connection is dropped only once the library knows of its end.

use core::cell::RefCell;

use embassy_time::{Duration, Timer};
use nrf_softdevice::{RawError, ble::Connection, raw};

/// Period at which the end of a connection is checked. It takes an interval or two, 30 ms, and 2 s where the armband
/// has gone.
const LOOK: Duration = Duration::from_millis(10);

#[derive(Default)]
pub struct Ending {
    /// Kept, so that it is not dropped too early.
    connection: RefCell<Option<Connection>>,
}

impl Ending {
    /// Ends a connection. The one before must have ended.
    pub fn begin(&self, connection: Connection) {
        disconnect(&connection);
        self.connection.replace(Some(connection));
    }

    /// Waits until there is no connection. A SoftDevice that never reports the end is ended by the watchdog, for nothing
    /// is heard of it.
    pub async fn finished(&self) {
        while self.is_up() {
            // Meanwhile the library takes the SoftDevice's events.
            Timer::after(LOOK).await;
        }
        self.connection.take();
    }

    /// Whether any connection is up; asks the SoftDevice again to end it.
    fn is_up(&self) -> bool {
        // The kept one among them. Another belongs to nobody: of an attempt to connect that was given up when it had just
        // succeeded. Its record stays counted, so this one more and one less disconnects nothing.
        Connection::iter().next().is_some_and(|connection| {
            disconnect(&connection);
            true
        })
    }
}

#[expect(
    unsafe_code,
    reason = "nrf-softdevice unwraps the answer of this call, which a link that ends by itself makes an error"
)]
fn disconnect(connection: &Connection) {
    let Some(handle) = connection.handle() else {
        return;
    };
    let reason = raw::BLE_HCI_REMOTE_USER_TERMINATED_CONNECTION as u8;
    // SAFETY: a `Connection` exists only while the SoftDevice is enabled, which the call requires. It takes two numbers; a
    // handle of a connection that has ended, or is ending, is answered with an error code.
    let code = unsafe { raw::sd_ble_gap_disconnect(handle, reason) };
    if let Err(error) = RawError::convert(code) {
        defmt::debug!("the connection ends already: {}", error);
    }
}
