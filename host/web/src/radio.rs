//! Events of a Bluetooth stack, with their bytes.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use shared::myo::{Action, Address, Characteristic, Found, MyoEvent, Uuid};

/// Event of the stack: an [`MyoEvent`] that owns its bytes, or the loss of the adapter.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(tag = "radio", rename_all = "snake_case")]
#[expect(missing_docs, reason = "as `Event` documents them")]
pub enum RadioEvent {
    #[serde(skip)]
    Advertisement {
        address: Address,
        rssi: i8,
        data: Vec<u8>,
    },
    ScanEnded,
    Connected,
    ConnectFailed,
    Discovered {
        #[serde(deserialize_with = "found")]
        found: Found,
    },
    Read {
        bytes: Vec<u8>,
    },
    Done,
    Failed,
    Notification {
        #[serde(deserialize_with = "characteristic")]
        characteristic: Characteristic,
        bytes: Vec<u8>,
    },
    Disconnected,
    /// The adapter is missing or was lost, with the reason.
    #[serde(skip)]
    Gone(String),
}

impl RadioEvent {
    /// Event as the session takes it.
    pub fn as_event(&self) -> MyoEvent<'_> {
        match self {
            Self::Advertisement {
                address,
                rssi,
                data,
            } => MyoEvent::Advertisement {
                address: *address,
                rssi: *rssi,
                data,
            },
            Self::ScanEnded => MyoEvent::ScanEnded,
            Self::Connected => MyoEvent::Connected,
            Self::ConnectFailed => MyoEvent::ConnectFailed,
            Self::Discovered { found } => MyoEvent::Discovered(*found),
            Self::Read { bytes } => MyoEvent::Read(bytes),
            Self::Done => MyoEvent::Done,
            Self::Failed => MyoEvent::Failed,
            Self::Notification {
                characteristic,
                bytes,
            } => MyoEvent::Notification {
                characteristic: *characteristic,
                bytes,
            },
            Self::Disconnected | Self::Gone(_) => MyoEvent::Disconnected,
        }
    }
}

/// Advertising data of a device that offers these services, 16 bytes each as on air. A stack gives them without framing, and
/// the session parses framed data.
pub fn advertising_data(services: impl IntoIterator<Item = [u8; 16]>) -> Vec<u8> {
    /// Type of a complete list of 128-bit service UUIDs (Supplement to the Bluetooth Core Specification, A 1.1).
    const ALL_UUIDS_128: u8 = 0x07;
    let framed = |uuid: [u8; 16]| {
        let mut structure = vec![1 + uuid.len() as u8, ALL_UUIDS_128];
        structure.extend(uuid);
        structure
    };
    services.into_iter().flat_map(framed).collect()
}

/// A UUID as browsers write it: `d5060001-a904-deb9-4748-2c7f4a124842`.
pub fn text_of(uuid: Uuid) -> String {
    let number = u128::from_le_bytes(uuid.to_le_bytes());
    let digits = format!("{number:032x}");
    let parts = [0..8, 8..12, 12..16, 16..20, 20..32].map(|range| &digits[range]);
    parts.join("-")
}

/// The characteristic of a UUID's text; none if it is not used here.
fn of_text(text: &str) -> Option<Characteristic> {
    Characteristic::ALL
        .into_iter()
        .find(|one| text_of(one.uuid()) == text)
}

/// Reads a characteristic by its UUID.
fn characteristic<'d, D: Deserializer<'d>>(input: D) -> Result<Characteristic, D::Error> {
    let text = String::deserialize(input)?;
    of_text(&text).ok_or_else(|| serde::de::Error::custom("no characteristic of an armband"))
}

/// Reads the characteristics of an armband by their UUIDs; others are passed over.
fn found<'d, D: Deserializer<'d>>(input: D) -> Result<Found, D::Error> {
    let texts = Vec::<String>::deserialize(input)?;
    Ok(texts.iter().filter_map(|text| of_text(text)).collect())
}

/// Writes the UUID of a characteristic.
fn uuid<S: Serializer>(of: &Characteristic, output: S) -> Result<S::Ok, S::Error> {
    output.serialize_str(&text_of(of.uuid()))
}

/// Action for the browser's Bluetooth. There is no scan: the wearer has chosen the armband.
#[derive(Serialize)]
#[serde(tag = "radio", rename_all = "snake_case")]
pub(crate) enum ForRadio {
    Connect,
    Discover,
    Disconnect,
    Read {
        #[serde(serialize_with = "uuid")]
        characteristic: Characteristic,
    },
    Subscribe {
        #[serde(serialize_with = "uuid")]
        characteristic: Characteristic,
    },
    Write {
        #[serde(serialize_with = "uuid")]
        characteristic: Characteristic,
        bytes: Vec<u8>,
    },
}

impl ForRadio {
    /// Action of a session for the browser; none for what the browser has no part in.
    pub(crate) fn of(action: Action) -> Option<Self> {
        Some(match action {
            Action::Connect(_) => Self::Connect,
            Action::Discover => Self::Discover,
            Action::Disconnect => Self::Disconnect,
            Action::Read(characteristic) => Self::Read { characteristic },
            Action::Subscribe(characteristic) => Self::Subscribe { characteristic },
            Action::Write(characteristic, payload) => Self::Write {
                characteristic,
                bytes: payload.as_slice().to_vec(),
            },
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uuids_are_written_as_browsers_write_them() {
        let control = "d5060001-a904-deb9-4748-2c7f4a124842";
        assert_eq!(text_of(Uuid::CONTROL), control);
        let battery = "00002a19-0000-1000-8000-00805f9b34fb";
        assert_eq!(of_text(battery), Some(Characteristic::BatteryLevel));
        assert_eq!(of_text(control), None);
    }

    #[test]
    fn a_browsers_events_are_read_and_others_refused() {
        let read = |text: &str| serde_json::from_str::<RadioEvent>(text).ok();
        let emg = text_of(Characteristic::ALL[2].uuid());
        let notification =
            format!(r#"{{"radio":"notification","characteristic":"{emg}","bytes":[1,255]}}"#);
        assert_eq!(
            read(&notification),
            Some(RadioEvent::Notification {
                characteristic: Characteristic::ALL[2],
                bytes: vec![1, 255],
            })
        );
        let found = format!(r#"{{"radio":"discovered","found":["{emg}","unknown"]}}"#);
        let expected = [Characteristic::ALL[2]].into_iter().collect();
        assert_eq!(
            read(&found),
            Some(RadioEvent::Discovered { found: expected })
        );
        assert_eq!(read(r#"{"radio":"done"}"#), Some(RadioEvent::Done));
        for wrong in [
            r#"{"radio":"notification","characteristic":"x","bytes":[]}"#,
            r#"{"radio":"read","bytes":[256]}"#,
            r#"{"radio":"gone"}"#,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
