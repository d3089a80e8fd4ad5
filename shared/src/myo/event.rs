//! Inputs of a session.

use super::address::Address;
use super::characteristic::{Characteristic, Found};

/// An event of the radio, or the passing of time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MyoEvent<'a> {
    /// An advertisement was received.
    Advertisement {
        /// The sender's address, of the kind that the report names.
        address: Address,
        /// Signal strength in dBm; 127 where the radio does not know it.
        rssi: i8,
        /// The advertising data.
        data: &'a [u8],
    },
    /// The Bluetooth stack has answered what takes no other device: it has begun a scan, or ended one in time. No more
    /// than a sign of life.
    Answered,
    /// The scan ended by itself, or did not start.
    ScanEnded,
    /// The requested connection is established.
    Connected,
    /// The requested connection failed, or was cancelled.
    ConnectFailed,
    /// Discovery succeeded and found these characteristics.
    Discovered(Found),
    /// The value of a read.
    Read(&'a [u8]),
    /// The write or the subscription succeeded.
    Done,
    /// The outstanding discovery, read, write or subscription failed.
    Failed,
    /// A notification was received.
    Notification {
        /// Characteristic that was notified.
        characteristic: Characteristic,
        /// Bytes of the value.
        bytes: &'a [u8],
    },
    /// The connection ended, whoever closed it.
    Disconnected,
    /// The wearer asks for a pairing: for 30 s armbands are collected, and the one with the strongest signal is bound.
    Pair,
    /// The wearer asks for this armband to be bound, or for none.
    Bind(Option<Address>),
    /// Only time passed. To be sent about every 50 ms; with fewer ticks retries, time-outs and
    /// keep-alives come later, and nothing else changes.
    Tick,
}
