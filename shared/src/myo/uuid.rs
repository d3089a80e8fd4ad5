//! UUIDs of services and characteristics, as they are on air.

/// A UUID of the armband: a 16-bit id in one of two families.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Uuid {
    /// Assigned by the Bluetooth SIG: 16 bits on air.
    Sig(u16),
    /// The vendor's, `d506XXXX-a904-deb9-4748-2c7f4a124842`: 128 bits on air.
    Vendor(u16),
}

/// Vendor UUID 0x0000 as it is on air: little-endian, the short id at bytes 12 and 13.
const VENDOR_BASE: [u8; 16] = [
    0x42, 0x48, 0x12, 0x4a, 0x7f, 0x2c, 0x48, 0x47, 0xb9, 0xde, 0x04, 0xa9, 0x00, 0x00, 0x06, 0xd5,
];
/// The SIG's base UUID, `0000XXXX-0000-1000-8000-00805f9b34fb`, in the same order.
const SIG_BASE: [u8; 16] = [
    0xfb, 0x34, 0x9b, 0x5f, 0x80, 0x00, 0x00, 0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
];
const SHORT_ID: usize = 12;

impl Uuid {
    /// The Control service, which an armband advertises.
    pub const CONTROL: Self = Self::Vendor(0x0001);

    /// All 128 bits, little-endian as on air.
    #[must_use]
    pub const fn to_le_bytes(self) -> [u8; 16] {
        let (mut bytes, short_id) = match self {
            Self::Sig(short_id) => (SIG_BASE, short_id),
            Self::Vendor(short_id) => (VENDOR_BASE, short_id),
        };
        [bytes[SHORT_ID], bytes[SHORT_ID + 1]] = short_id.to_le_bytes();
        bytes
    }

    /// The UUID of 2 or 16 bytes, little-endian as on air; none for another family or length.
    #[must_use]
    pub fn from_le_bytes(bytes: &[u8]) -> Option<Self> {
        if let Ok(short_id) = bytes.try_into() {
            return Some(Self::Sig(u16::from_le_bytes(short_id)));
        }
        let bytes: [u8; 16] = bytes.try_into().ok()?;
        let short_id = u16::from_le_bytes([bytes[SHORT_ID], bytes[SHORT_ID + 1]]);
        [Self::Sig(short_id), Self::Vendor(short_id)]
            .into_iter()
            .find(|uuid| uuid.to_le_bytes() == bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_control_service_has_its_captured_bytes() {
        let captured = [
            0x42, 0x48, 0x12, 0x4a, 0x7f, 0x2c, 0x48, 0x47, 0xb9, 0xde, 0x04, 0xa9, 0x01, 0x00,
            0x06, 0xd5,
        ];
        assert_eq!(Uuid::CONTROL.to_le_bytes(), captured);
        assert_eq!(Uuid::from_le_bytes(&captured), Some(Uuid::CONTROL));
    }

    #[test]
    fn a_sig_uuid_is_the_same_in_16_and_in_128_bits() {
        let battery = Uuid::Sig(0x180f);
        assert_eq!(Uuid::from_le_bytes(&[0x0f, 0x18]), Some(battery));
        assert_eq!(Uuid::from_le_bytes(&battery.to_le_bytes()), Some(battery));
    }

    #[test]
    fn other_families_and_lengths_are_none() {
        let mut other = Uuid::CONTROL.to_le_bytes();
        other[0] ^= 1;
        assert_eq!(Uuid::from_le_bytes(&other), None);
        for length in [0, 1, 3, 15] {
            assert_eq!(Uuid::from_le_bytes(&other[..length]), None);
        }
    }
}
