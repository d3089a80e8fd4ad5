//! Interface of the two Bluetooth stacks, no wider than [`driver`] needs.

pub mod driver;
#[cfg(any(feature = "radio-trouble", not(target_os = "none")))]
mod guarded;
mod handles;
#[cfg(all(feature = "radio-softdevice", target_os = "none"))]
pub mod softdevice;
#[cfg(any(feature = "radio-trouble", not(target_os = "none")))]
pub mod trouble;

use shared::myo::Address;

/// Bytes of the longest advertisement, and of the longest value that is read or received.
pub const MAX_VALUE_BYTES: usize = 31;

/// Enables notifications when written to the descriptor 0x2902 (Bluetooth Core, Vol 3, Part G,
/// 3.3.3.3).
const ENABLE_NOTIFICATIONS: [u8; 2] = [1, 0];

/// An advertisement of an armband or of any other device.
#[derive(Clone, Copy)]
pub struct Advertisement {
    pub address: Address,
    pub rssi: i8,
    bytes: [u8; MAX_VALUE_BYTES],
    length: usize,
}

impl Advertisement {
    /// Copies the data; they fit where the advertisement is a legacy one, and are cut where not.
    pub fn new(address: Address, rssi: i8, data: &[u8]) -> Self {
        let mut bytes = [0; MAX_VALUE_BYTES];
        let length = data.len().min(MAX_VALUE_BYTES);
        bytes[..length].copy_from_slice(&data[..length]);
        Self {
            address,
            rssi,
            bytes,
            length,
        }
    }

    /// AD structures of the advertisement.
    pub fn data(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

pub struct ConnectFailed;

/// An operation did not succeed. The cause is only logged.
pub struct OperationFailed;

pub struct Disconnected;

pub enum Scanned<'a> {
    /// The stack has answered: it has begun the scan, or ended it in time.
    Answered,
    Advertisement(&'a Advertisement),
}

/// Seconds after which a scan is begun again, so that the stack answers where no device advertises.
pub const SCAN_SECONDS: u16 = 10;

/// Share of the time for which a scan receives.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    Always,
    /// One window in [`REST`]: an armband that advertises is heard ten times later, on average.
    Seldom,
}

/// Windows from one to the next of a scan that receives seldom.
pub const REST: u16 = 10;

/// A Bluetooth stack as a central.
///
/// Every future may be dropped, which ends its operation.
pub trait Radio {
    /// True if an erasure of flash finds its time beside scans and connections. Where it does not, the radio is not used
    /// while a model is installed.
    const LEAVES_FLASH_TIME: bool;

    /// Scans passively for as long as it is polled, and passes every advertisement on; every [`SCAN_SECONDS`] at the latest
    /// it says that the stack has answered, if it has, and asks for the pace. Returns where the stack refuses to scan.
    async fn scan(&mut self, pace: impl Fn() -> Pace, report: impl FnMut(Scanned<'_>));

    /// Waits until nothing is left of an operation that was dropped.
    async fn silence(&mut self);

    /// Connects, runs the handler on the connection, and disconnects when the handler returns. Fails if no connection was
    /// established: the handler was not run then.
    async fn connect(
        &mut self,
        address: Address,
        handler: &impl ConnectionHandler,
    ) -> Result<(), ConnectFailed>;
}

pub trait ConnectionHandler {
    /// Runs on a link that has just been established.
    async fn run(&self, link: &impl Link);
}

/// A connection to an armband. Attributes are addressed by their handles.
pub trait Link {
    /// Reads a value; returns its length. Other data that the stack receives meanwhile is not an answer.
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed>;

    /// Writes a value, with response.
    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed>;

    /// Passes notifications on, by the handle of their value, until the connection ends.
    ///
    /// Once it was called nothing can be read any more, and a write may be reported as done before
    /// its response.
    async fn listen(&self, on_notification: impl FnMut(u16, &[u8])) -> Disconnected;
}
