//! What the two Bluetooth stacks have in common, and no more than [`follow`] needs of them.

pub mod follow;
mod handles;
#[cfg(feature = "radio-softdevice")]
pub mod softdevice;
#[cfg(feature = "radio-hci")]
pub mod trouble;

use handles::Handles;
use shared::myo::Address;

/// Longest advertisement, and longest value that is read or received.
pub const MOST_BYTES: usize = 31;

/// What asks for notifications, written to the descriptor 0x2902 (Bluetooth Core, Vol 3, Part G,
/// 3.3.3.3).
const SUBSCRIBE: [u8; 2] = [1, 0];

/// An armband, or anything else, that made itself heard.
#[derive(Clone, Copy)]
pub struct Advertisement {
    /// Whose.
    pub address: Address,
    /// Signal strength, dBm.
    pub rssi: i8,
    bytes: [u8; MOST_BYTES],
    length: usize,
}

impl Advertisement {
    /// Keeps what fits; a legacy advertisement does.
    pub fn new(address: Address, rssi: i8, data: &[u8]) -> Self {
        let mut bytes = [0; MOST_BYTES];
        let length = data.len().min(MOST_BYTES);
        bytes[..length].copy_from_slice(&data[..length]);
        Self {
            address,
            rssi,
            bytes,
            length,
        }
    }

    /// Its AD structures.
    pub fn data(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// No connection came about.
pub struct ConnectFailed;

/// An operation did not succeed. Which way matters only to the log.
pub struct OperationFailed;

/// The connection is gone.
pub struct Disconnected;

/// A Bluetooth stack as a central.
///
/// Every future may be dropped, which ends what it did.
pub trait Radio {
    /// Listens passively for as long as it is polled, and passes on all that is heard. Returns
    /// where the stack gives up.
    async fn scan(&mut self, heard: impl FnMut(&Advertisement));

    /// Connects, talks, and disconnects when the talk is over.
    ///
    /// # Errors
    /// If no connection came about; nothing was said then.
    async fn connect(
        &mut self,
        address: Address,
        conversation: &impl Conversation,
    ) -> Result<(), ConnectFailed>;
}

/// What is done while a connection lasts.
pub trait Conversation {
    /// Talks; the link is alive when it begins.
    async fn talk(&self, link: &impl Link);
}

/// A connection to an armband. Attributes go by the handles that discovery found.
pub trait Link {
    /// Finds the armband's characteristics, by UUID.
    async fn discover(&self) -> Result<Handles, OperationFailed>;

    /// Reads a value; gives its length.
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed>;

    /// Writes a value, with response.
    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed>;

    /// Passes notifications on, by the handle of their value, until the connection is gone.
    ///
    /// From then on nothing is read, and a write may be taken as done before its response.
    async fn listen(&self, notified: impl FnMut(u16, &[u8])) -> Disconnected;
}
