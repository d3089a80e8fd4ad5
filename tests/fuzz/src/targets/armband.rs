//! Armbands: their advertising data, attributes, notifications, and the flash record of the bound one.

use shared::myo::binding::{RECORD_BYTES, from_record, to_record};
use shared::myo::{
    Attribute, Characteristic, Discovery, MyoEvent, MyoSession, Phase, Settings, Uuid,
};
use shared::units::Millis;

use crate::input::Input;
use crate::radio::{FuzzLink, address};

/// Takes the data of one advertisement: the session follows only data that lists the armband's service.
pub fn advertisement(data: &[u8]) {
    let mut session = MyoSession::new(Settings {
        follow_strongest: true,
        ..Settings::default()
    });
    let mut at = |now, event| session.handle(Millis(now), event, &mut |_| {});
    at(0, MyoEvent::Tick);
    at(
        1,
        MyoEvent::Advertisement {
            address: address(1),
            rssi: -40,
            data,
        },
    );
    at(1000, MyoEvent::Tick);
    let followed = session.phase() == Phase::Connecting;
    assert_eq!(followed, lists_the_service(data));
}

/// Looks for the service by a plain walk over the structures.
fn lists_the_service(data: &[u8]) -> bool {
    let mut at = 0;
    while at < data.len() {
        let end = at + 1 + usize::from(data[at]);
        if end > data.len() {
            return false;
        }
        if end == at + 1 {
            // A length of zero ends the data, or pads it.
            return false;
        }
        let (kind, value) = (data[at + 1], &data[at + 2..end]);
        let whole = value.len() / 16 * 16;
        let listed = value[..whole]
            .chunks(16)
            .any(|uuid| uuid == Uuid::CONTROL.to_le_bytes());
        if (kind == 6 || kind == 7) && listed {
            return true;
        }
        at = end;
    }
    false
}

/// Takes attributes of a device that calls itself an armband: a value for each read, short and with its length in front; 255: the read is refused.
pub fn discovery(data: &[u8]) {
    let mut input = Input(data);
    let mut discovery = Discovery::default();
    let (mut reads, mut last, mut found) = (0, 0, Vec::new());
    while let Some(handle) = discovery.handle() {
        reads += 1;
        assert!(
            handle > last && handle <= 128 && reads <= 128,
            "the search ends"
        );
        last = handle;
        let value = match input.byte() {
            u8::MAX => None,
            count => Some(input.take(usize::from(count % 32))),
        };
        let Some(attribute) = discovery.answered(value) else {
            continue;
        };
        let (Attribute::Value(_, place) | Attribute::Subscription(_, place)) = attribute;
        assert!((1..=128).contains(&place), "a handle that was looked at");
        assert!(!found.contains(&attribute), "named twice");
        found.push(attribute);
    }
}

/// Takes notifications of a running stream, each a byte for its kind, the time since the one before, and perhaps bytes.
pub fn notification(data: &[u8]) {
    let mut input = Input(data);
    let mut link = FuzzLink::streaming(input.word());
    while !input.is_empty() {
        let kind = input.byte();
        link.wait(input.pause());
        match kind {
            0..=199 => link.emg(usize::from(kind)),
            _ => {
                let characteristic = Characteristic::ALL[usize::from(kind) % 8];
                let bytes = input.short();
                link.handle(MyoEvent::Notification {
                    characteristic,
                    bytes,
                });
            }
        }
    }
}

/// Takes the flash record of the bound armband, unchanged and with its checksum made right.
pub fn binding(data: &[u8]) {
    let mut record: [u8; RECORD_BYTES] = Input(data).array();
    check_record(&record);
    let (content, checksum) = record.split_at_mut(RECORD_BYTES - 4);
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(content);
    checksum.copy_from_slice(&sum.to_le_bytes());
    check_record(&record);
}

fn check_record(record: &[u8; RECORD_BYTES]) {
    if let Some(armband) = from_record(record) {
        assert_eq!(to_record(armband), *record, "what is read is written back");
        assert!(record.starts_with(b"MyoB\x01"));
    }
}
