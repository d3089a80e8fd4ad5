//! Channels between the session and a Bluetooth stack, which has a thread of its own.

use std::sync::mpsc::Receiver;

use shared::myo::{Action, Address, Characteristic, Event, Found};
use tokio::sync::mpsc::UnboundedSender;

/// Session's ends of both channels.
#[derive(Debug)]
pub(super) struct Radio {
    /// Actions for the stack, in order, without those for the pipeline. Closing the channel ends the stack.
    pub(super) actions: UnboundedSender<Action>,
    /// Results of actions, and events of the stack.
    pub(super) events: Receiver<RadioEvent>,
}

/// Event of the stack: an [`Event`] that owns its bytes, or the loss of the adapter.
#[cfg_attr(
    not(feature = "bluetooth"),
    expect(dead_code, reason = "the adapter alone says some of them")
)]
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum RadioEvent {
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
    /// The adapter is missing or was lost, with the reason.
    Gone(String),
}

impl RadioEvent {
    /// Event as the session takes it.
    pub(super) fn as_event(&self) -> Event<'_> {
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

/// Advertising data of a device that offers these services, 16 bytes each as on air. A stack gives them without framing, and
/// the session parses framed data.
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
