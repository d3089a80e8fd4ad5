//! Outputs of a session.

use super::address::Address;
use super::characteristic::Characteristic;
use super::packet::{Imu, Pair};

/// Most bytes of a write: the payload of the smallest ATT packet.
const MAX_PAYLOAD: usize = 20;

/// Bytes to write: at most 20.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Payload {
    bytes: [u8; MAX_PAYLOAD],
    length: u8,
}

impl Payload {
    /// A payload of these bytes. More than 20 fail to compile.
    #[must_use]
    pub(super) const fn new<const LENGTH: usize>(payload: [u8; LENGTH]) -> Self {
        const { assert!(LENGTH <= MAX_PAYLOAD) };
        let mut bytes = [0; MAX_PAYLOAD];
        bytes.split_at_mut(LENGTH).0.copy_from_slice(&payload);
        Self {
            bytes,
            length: LENGTH as u8,
        }
    }

    /// The bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

/// A request to the radio or the pipeline. Requests are to be carried out in order.
///
/// `Connect`, `Discover`, `Read`, `Subscribe` and `Write` are operations: at most one is outstanding.
/// Each is answered by its own [`MyoEvent`](super::MyoEvent), or by `Disconnected`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action {
    /// Scan passively and report every advertisement. Answered by any number of `Advertisement`.
    Scan,
    /// Stop the scan. Not answered.
    StopScan,
    /// Connect with an interval of 7.5 to 15 ms and no latency: a longer one loses data. Answered by
    /// `Connected` or `ConnectFailed`.
    Connect(Address),
    /// Discover the characteristics by their UUIDs. Answered by `Discovered` or `Failed`.
    Discover,
    /// Read a value. Answered by `Read` or `Failed`.
    Read(Characteristic),
    /// Enable a characteristic's notifications. Answered by `Done` or `Failed`.
    Subscribe(Characteristic),
    /// Write a value, with response. Answered by `Done` or `Failed`.
    Write(Characteristic, Payload),
    /// Close the connection, or cancel connecting; an outstanding operation ends. Answered by
    /// `Disconnected`, or by `ConnectFailed` where there was no connection yet.
    Disconnect,
    /// Two samples for the pipeline, the older first. They follow the samples delivered before, unless
    /// a `Gap` or `StreamEnded` came between.
    Deliver(Pair),
    /// Movement of the armband, as it arrived: after the samples delivered before, some of which may be held back.
    Imu(Imu),
    /// Keep this armband as the bound one over restarts, or none. To be done before the next connection, and not while one
    /// lasts. Not answered.
    Keep(Option<Address>),
    /// Samples are missing between the previous delivery and the next.
    Gap {
        /// Their number: exact for up to 6 consecutive samples, else an estimate, and never 0.
        missing: u32,
    },
    /// The running stream ended.
    StreamEnded,
}
