//! What a session asks for.

use super::address::Address;
use super::characteristic::Characteristic;
use super::packet::Pair;

/// Most bytes of a write: what fits into the smallest packet of the protocol.
pub const MAX_PAYLOAD: usize = 20;

/// Bytes to write, at most 20.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Payload {
    bytes: [u8; MAX_PAYLOAD],
    length: u8,
}

impl Payload {
    /// These bytes; more than 20 do not compile.
    #[must_use]
    pub const fn new<const LENGTH: usize>(payload: [u8; LENGTH]) -> Self {
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

/// One thing to do. To be done in the order of the actions.
///
/// `Connect`, `Discover`, `Read`, `Subscribe` and `Write` are operations: never two of them are
/// outstanding. Each is answered by its own [`Event`](super::Event), or by `Disconnected`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action {
    /// Scan, passively, and tell of every advertisement heard. Answered by any number of `Advertisement`.
    Scan,
    /// Scan no more. Nothing answers.
    StopScan,
    /// Connect, with an interval of 7.5 to 15 ms and no latency: a longer one costs data. Answered
    /// by `Connected` or `ConnectFailed`.
    Connect(Address),
    /// Find the characteristics by their UUIDs. Answered by `Discovered` or `Failed`.
    Discover,
    /// Read a value. Answered by `Read` or `Failed`.
    Read(Characteristic),
    /// Have a characteristic notify. Answered by `Done` or `Failed`.
    Subscribe(Characteristic),
    /// Write a value, with response. Answered by `Done` or `Failed`.
    Write(Characteristic, Payload),
    /// Close the connection, or give up connecting; an operation under way is over. Answered by
    /// `Disconnected`, or by `ConnectFailed` where there was no connection yet.
    Disconnect,
    /// Two samples for the pipeline, the older first. They follow those delivered before unless a
    /// `Gap` or `StreamEnded` came between.
    Deliver(Pair),
    /// Samples are missing between those delivered before and those to come.
    Gap {
        /// How many: exact for up to 6 samples in a row, else the best guess, and never 0.
        missing: u32,
    },
    /// The stream that had begun is over.
    StreamEnded,
}
