//! Attributes of the armband: the order of its services gives each the handle that it has in logs of real armbands.

use shared::myo::{Characteristic, Uuid};

/// Bytes of an advertisement of a real armband: name, flags, Control Service.
pub const ADVERTISEMENT: [u8; 31] = [
    9, 8, b'M', b'y', b'o', 0, 0, 0, 0, 0, 2, 1, 6, 17, 6, 0x42, 0x48, 0x12, 0x4a, 0x7f, 0x2c,
    0x48, 0x47, 0xb9, 0xde, 0x04, 0xa9, 0x01, 0x00, 0x06, 0xd5,
];
/// Value of the firmware version: major, minor, patch, hardware.
pub const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];
/// The characteristic of the preferred connection parameters.
const PREFERRED: Uuid = Uuid::Sig(0x2a04);
/// Value of the characteristic: 7.5 to 15 ms, no latency, 3 s. What a real armband prefers is not known.
pub const PREFERRED_PARAMETERS: [u8; 8] = [6, 0, 12, 0, 0, 0, 44, 1];
/// Connection parameters that an armband asks for: 20 to 40 ms, no latency, 2 s.
pub const ASKED_PARAMETERS: [u16; 4] = [16, 32, 0, 200];
/// Handle of the table without a subscription.
pub const FOREIGN: u16 = 0x27;

/// Kind and value of an attribute.
#[derive(Clone, Debug)]
pub enum Attribute {
    /// Constant value.
    Constant(Vec<u8>),
    /// Value of a characteristic that is used.
    Value(Characteristic),
    /// Descriptor that enables the notifications of a characteristic.
    Subscription(Characteristic),
    /// Attribute that cannot be read.
    Other,
}

/// Services: each with its UUID, true if its characteristics notify, and their UUIDs of the same kind.
const SERVICES: [(Uuid, bool, &[u16]); 10] = [
    (Uuid::Sig(0x1800), false, &[0x2a00, 0x2a01, 0x2a04]),
    (Uuid::Sig(0x1801), true, &[0x2a05]),
    (Uuid::Sig(0x180a), false, &[0x2a29]),
    (Uuid::Sig(0x180f), true, &[0x2a19]),
    (Uuid::Vendor(0x0001), false, &[0x0101, 0x0201, 0x0401]),
    (Uuid::Vendor(0x0002), true, &[0x0402, 0x0502]),
    (Uuid::Vendor(0x0003), true, &[0x0103]),
    (Uuid::Vendor(0x0004), true, &[0x0104]),
    (
        Uuid::Vendor(0x0005),
        true,
        &[0x0105, 0x0205, 0x0305, 0x0405],
    ),
    (Uuid::Vendor(0x0006), true, &[0x0602]),
];

/// EMG characteristics, in the order of a stream.
pub const EMG: [Characteristic; 4] = [
    Characteristic::ALL[2],
    Characteristic::ALL[3],
    Characteristic::ALL[4],
    Characteristic::ALL[5],
];

/// Returns all attributes, the first one with handle 1.
pub fn table() -> Vec<Attribute> {
    let mut table = Vec::new();
    for (service, notifies, characteristics) in SERVICES {
        table.push(Attribute::Constant(on_air(service)));
        for short in characteristics {
            let uuid = match service {
                Uuid::Sig(_) => Uuid::Sig(*short),
                Uuid::Vendor(_) => Uuid::Vendor(*short),
            };
            let value_handle = table.len() as u16 + 2;
            let mut declaration = vec![0];
            declaration.extend(value_handle.to_le_bytes());
            declaration.extend(on_air(uuid));
            table.push(Attribute::Constant(declaration));
            let used = Characteristic::from_uuid(uuid);
            let other = match uuid {
                PREFERRED => Attribute::Constant(PREFERRED_PARAMETERS.to_vec()),
                _ => Attribute::Other,
            };
            table.push(used.map_or(other, Attribute::Value));
            if notifies {
                let constant = Attribute::Constant(vec![0, 0]);
                table.push(used.map_or(constant, Attribute::Subscription));
            }
        }
    }
    table
}

fn on_air(uuid: Uuid) -> Vec<u8> {
    match uuid {
        Uuid::Sig(short) => short.to_le_bytes().to_vec(),
        Uuid::Vendor(_) => uuid.to_le_bytes().to_vec(),
    }
}

/// Returns the handle of a characteristic's value.
pub fn value_handle(table: &[Attribute], characteristic: Characteristic) -> u16 {
    let is_value = |one: &Attribute| matches!(one, Attribute::Value(it) if *it == characteristic);
    // Every characteristic that is used is in the table.
    table
        .iter()
        .position(is_value)
        .map_or(0, |place| place as u16 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_are_those_of_real_armbands() {
        let table = table();
        let handle = |characteristic| value_handle(&table, characteristic);
        assert_eq!(handle(Characteristic::Command), 0x19);
        let emg = EMG.map(handle);
        assert_eq!(emg, [0x2b, 0x2e, 0x31, 0x34]);
    }
}
