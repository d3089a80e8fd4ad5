//! What the session says to a Bluetooth stack and hears from it, over channels: the stack has a thread of its own.

use std::sync::mpsc::Receiver;

use shared::myo::{Action, Address, Characteristic, Event, Found};
use tokio::sync::mpsc::UnboundedSender;

/// The session's ends of both channels.
#[derive(Debug)]
pub(super) struct Radio {
    /// To be carried out in order; none that is for the pipeline. Its end ends the stack.
    pub(super) actions: UnboundedSender<Action>,
    /// What came of them, and what comes by itself.
    pub(super) heard: Receiver<Heard>,
}

/// An [`Event`] that owns its bytes.
#[cfg_attr(
    not(feature = "bluetooth"),
    expect(dead_code, reason = "the adapter alone says some of them")
)]
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Heard {
    Advertisement {
        address: Address,
        rssi: i8,
        data: Vec<u8>,
    },
    ScanEnded,
    Connected,
    ConnectFailed,
    Discovered(Found),
    Read(Vec<u8>),
    Done,
    Failed,
    Notification {
        characteristic: Characteristic,
        bytes: Vec<u8>,
    },
    Disconnected,
    /// There is no adapter, or no longer one: why.
    Gone(String),
}

impl Heard {
    /// As the session takes it.
    pub(super) fn event(&self) -> Event<'_> {
        match self {
            Self::Advertisement {
                address,
                rssi,
                data,
            } => Event::Advertisement {
                address: *address,
                rssi: *rssi,
                data,
            },
            Self::ScanEnded => Event::ScanEnded,
            Self::Connected => Event::Connected,
            Self::ConnectFailed => Event::ConnectFailed,
            Self::Discovered(found) => Event::Discovered(*found),
            Self::Read(bytes) => Event::Read(bytes),
            Self::Done => Event::Done,
            Self::Failed => Event::Failed,
            Self::Notification {
                characteristic,
                bytes,
            } => Event::Notification {
                characteristic: *characteristic,
                bytes,
            },
            Self::Disconnected | Self::Gone(_) => Event::Disconnected,
        }
    }
}

/// The advertising data of a device that offers these services, 16 bytes each as on air: a stack gives them without their
/// frame, and the session reads frames.
pub(super) fn advertising_data(services: impl IntoIterator<Item = [u8; 16]>) -> Vec<u8> {
    /// Type of a complete list of 128-bit service UUIDs (Supplement to the Bluetooth Core Specification, A 1.1).
    const ALL_UUIDS_128: u8 = 0x07;
    let framed = |uuid: [u8; 16]| {
        let mut structure = vec![1 + uuid.len() as u8, ALL_UUIDS_128];
        structure.extend(uuid);
        structure
    };
    services.into_iter().flat_map(framed).collect()
}
