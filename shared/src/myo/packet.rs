//! Parsers of what the armband sends. Each value has a minimum length; bytes beyond it are ignored,
//! since newer firmware may send more.

use crate::units::{CHANNELS, Sample};
use core::array::from_fn;

/// Two samples, the older first; the newer follows 5 ms later.
pub type Pair = [Sample; 2];

/// Samples of a notification.
pub(super) const PAIR_SAMPLES: u32 = 2;

/// A value is shorter than its minimum length.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("expected at least {expected} bytes, found {found}: the value is dropped")]
pub(super) struct TooShort {
    /// Bytes that it must have.
    pub expected: usize,
    /// Bytes that it has.
    pub found: usize,
}

/// The samples of an EMG notification: 2 x 8 x i8, channel 1 first.
pub(super) fn parse_emg(bytes: &[u8]) -> Result<Pair, TooShort> {
    let bytes = first::<{ 2 * CHANNELS }>(bytes)?;
    Ok(from_fn(|sample| {
        from_fn(|channel| bytes[sample * CHANNELS + channel].cast_signed())
    }))
}

/// Movement of the armband: quaternion w, x, y, z; acceleration x, y, z; turn rate x, y, z; as the armband sends them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Imu(pub [i16; 10]);

impl Imu {
    /// The movement of an IMU value: 10 x i16, little-endian.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, TooShort> {
        let bytes = first::<20>(bytes)?;
        let (pairs, _) = bytes.as_chunks();
        Ok(Self(from_fn(|value| i16::from_le_bytes(pairs[value]))))
    }

    /// Orientation: a unit quaternion w, x, y, z.
    #[must_use]
    pub fn quaternion(&self) -> [f32; 4] {
        from_fn(|axis| f32::from(self.0[axis]) / 16_384.0)
    }

    /// Acceleration x, y, z in g.
    #[must_use]
    pub fn acceleration(&self) -> [f32; 3] {
        from_fn(|axis| f32::from(self.0[4 + axis]) / 2048.0)
    }

    /// Turn rate x, y, z in degrees a second.
    #[must_use]
    pub fn turn_rate(&self) -> [f32; 3] {
        from_fn(|axis| f32::from(self.0[7 + axis]) / 16.0)
    }
}

/// The charge in a Battery Level value, percent 0..=100.
pub(super) fn parse_battery(bytes: &[u8]) -> Result<u8, TooShort> {
    let [percent] = *first::<1>(bytes)?;
    Ok(percent.min(100))
}

/// The armband's firmware.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct FirmwareVersion {
    /// Major version: another one is another protocol.
    pub major: u16,
    /// Minor version. The vendor describes 1.2.
    pub minor: u16,
    /// Patch level.
    pub patch: u16,
    /// Hardware revision: 1 is rev C, 2 is rev D.
    pub hardware: u16,
}

impl FirmwareVersion {
    /// The version of a Firmware Version value: 4 x u16, little-endian (the vendor's header claims
    /// big-endian; armbands disagree).
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, TooShort> {
        let [a, b, c, d, e, f, g, h] = *first::<8>(bytes)?;
        Ok(Self {
            major: u16::from_le_bytes([a, b]),
            minor: u16::from_le_bytes([c, d]),
            patch: u16::from_le_bytes([e, f]),
            hardware: u16::from_le_bytes([g, h]),
        })
    }

    /// Whether the firmware uses the protocol of this module. Major version 0 used the same numbers differently.
    #[must_use]
    pub(super) const fn is_supported(self) -> bool {
        self.major > 0
    }
}

fn first<const LENGTH: usize>(bytes: &[u8]) -> Result<&[u8; LENGTH], TooShort> {
    bytes.first_chunk().ok_or(TooShort {
        expected: LENGTH,
        found: bytes.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIXTEEN: [u8; 16] = [
        0, 1, 127, 128, 255, 5, 6, 7, // older
        8, 9, 10, 11, 12, 13, 14, 15, // newer
    ];

    #[test]
    fn a_notification_is_two_samples_the_older_first() {
        let pair = [
            [0, 1, 127, -128, -1, 5, 6, 7],
            [8, 9, 10, 11, 12, 13, 14, 15],
        ];
        assert_eq!(parse_emg(&SIXTEEN), Ok(pair));
    }

    #[test]
    fn a_short_value_is_refused_and_a_long_one_is_cut() {
        let (expected, found) = (16, 15);
        let error = TooShort { expected, found };
        assert_eq!(parse_emg(&SIXTEEN[..15]), Err(error));
        let mut long = [7; 20];
        long[..16].copy_from_slice(&SIXTEEN);
        assert_eq!(parse_emg(&long), parse_emg(&SIXTEEN));
        assert!(parse_battery(&[]).is_err());
        assert_eq!(parse_battery(&[55, 9]), Ok(55));
        assert_eq!(parse_battery(&[255]), Ok(100));
        assert!(FirmwareVersion::parse(&SIXTEEN[..7]).is_err());
    }

    #[test]
    fn movement_is_ten_values_in_their_units() {
        let values: [i16; 10] = [16_384, -8192, 0, 1, 2048, -2048, 1024, 16, -1600, 8];
        let bytes = values.map(i16::to_le_bytes);
        let imu = Imu::parse(bytes.as_flattened()).unwrap();
        assert_eq!(imu, Imu(values));
        assert_eq!(imu.quaternion(), [1.0, -0.5, 0.0, 1.0 / 16_384.0]);
        assert_eq!(imu.acceleration(), [1.0, -1.0, 0.5]);
        assert_eq!(imu.turn_rate(), [1.0, -100.0, 0.5]);
        assert!(Imu::parse(&bytes.as_flattened()[..19]).is_err());
    }

    #[test]
    fn the_firmware_of_real_armbands_is_supported() {
        let version = |bytes: [u8; 8]| FirmwareVersion::parse(&bytes).unwrap();
        let newest = version([1, 0, 5, 0, 0xb2, 0x07, 2, 0]);
        assert_eq!((newest.major, newest.minor, newest.patch), (1, 5, 1970));
        assert!(newest.is_supported());
        assert!(version([1, 0, 1, 0, 0xf3, 0x02, 2, 0]).is_supported());
        assert!(!version([0, 0, 8, 0, 0, 0, 1, 0]).is_supported());
    }
}
