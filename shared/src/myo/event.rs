//! What a session hears.

use super::address::Address;
use super::characteristic::{Characteristic, Found};

/// Something that happened to the radio, or time that passed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Event<'a> {
    /// Somebody advertises.
    Advertisement {
        /// Who, with the kind of address that the report names.
        address: Address,
        /// How loud, in dBm; 127 where the radio does not know.
        rssi: i8,
        /// The advertising data.
        data: &'a [u8],
    },
    /// The scan ended by itself, or could not start.
    ScanEnded,
    /// The connection asked for is there.
    Connected,
    /// There will be no such connection.
    ConnectFailed,
    /// Discovery ended, with these characteristics.
    Discovered(Found),
    /// The value asked for.
    Read(&'a [u8]),
    /// A write or a subscription is confirmed.
    Done,
    /// The outstanding discovery, read, write or subscription failed.
    Failed,
    /// A characteristic notified.
    Notification {
        /// Which.
        characteristic: Characteristic,
        /// Its value.
        bytes: &'a [u8],
    },
    /// The connection is gone, whoever closed it.
    Disconnected,
    /// Nothing but time passed. Due about every 50 ms, for nothing else wakes the session: with
    /// fewer ticks retries, time-outs and the watchdog come later, and nothing else changes.
    Tick,
}
