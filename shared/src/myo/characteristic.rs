//! The armband's characteristics that are used here.

use super::lane::Lane;
use super::uuid::Uuid;

/// A characteristic of the armband.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Characteristic {
    /// Read: 8 bytes, see [`FirmwareVersion`](super::FirmwareVersion).
    FirmwareVersion,
    /// Written **with response** only: the armband ignores a write without response, and reports no error.
    Command,
    /// Notifies: two samples in 16 bytes.
    Emg(Lane),
    /// Read, and notifies: percent.
    BatteryLevel,
    /// Notifies: see [`Imu`](super::Imu).
    Imu,
}

impl Characteristic {
    /// Every characteristic that is used.
    pub const ALL: [Self; 8] = [
        Self::FirmwareVersion,
        Self::Command,
        Self::Emg(Lane::ALL[0]),
        Self::Emg(Lane::ALL[1]),
        Self::Emg(Lane::ALL[2]),
        Self::Emg(Lane::ALL[3]),
        Self::BatteryLevel,
        Self::Imu,
    ];

    /// UUID of the characteristic.
    #[must_use]
    pub const fn uuid(self) -> Uuid {
        match self {
            Self::FirmwareVersion => Uuid::Vendor(0x0201),
            Self::Command => Uuid::Vendor(0x0401),
            Self::Emg(lane) => Uuid::Vendor(0x0105 + 0x0100 * lane.number() as u16),
            Self::BatteryLevel => Uuid::Sig(0x2a19),
            Self::Imu => Uuid::Vendor(0x0402),
        }
    }

    /// The characteristic of a UUID; none where it is not used here.
    #[must_use]
    pub fn from_uuid(uuid: Uuid) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.uuid() == uuid)
    }

    /// Index in [`Characteristic::ALL`], 0..=7, for a radio's table of handles.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::FirmwareVersion => 0,
            Self::Command => 1,
            Self::Emg(lane) => 2 + lane.number() as usize,
            Self::BatteryLevel => 6,
            Self::Imu => 7,
        }
    }
}

/// The characteristics that discovery found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Found(u8);

impl Found {
    /// The empty set.
    pub(super) const NONE: Self = Self(0);

    /// The set with `characteristic` added.
    #[must_use]
    pub const fn with(self, characteristic: Characteristic) -> Self {
        Self(self.0 | 1 << characteristic.index())
    }

    /// Whether `characteristic` was found.
    #[must_use]
    pub(super) const fn contains(self, characteristic: Characteristic) -> bool {
        self.0 & (1 << characteristic.index()) != 0
    }

    /// Whether a stream can be set up: only the battery level and the IMU may be missing.
    #[must_use]
    pub(super) const fn is_sufficient(self) -> bool {
        self.with(Characteristic::BatteryLevel)
            .with(Characteristic::Imu)
            .0
            == u8::MAX
    }
}

const _: () = assert!(Characteristic::ALL.len() == u8::BITS as usize);

impl FromIterator<Characteristic> for Found {
    fn from_iter<I: IntoIterator<Item = Characteristic>>(found: I) -> Self {
        found.into_iter().fold(Self::NONE, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uuids_and_indices_lead_back_to_their_characteristic() {
        for (place, characteristic) in Characteristic::ALL.into_iter().enumerate() {
            assert_eq!(characteristic.index(), place);
            let uuid = characteristic.uuid();
            assert_eq!(Characteristic::from_uuid(uuid), Some(characteristic));
        }
        let classifier = Uuid::Vendor(0x0103);
        assert_eq!(Characteristic::from_uuid(classifier), None);
    }

    #[test]
    fn the_lanes_have_the_vendors_ids() {
        let ids = Lane::ALL.map(|lane| Characteristic::Emg(lane).uuid());
        assert_eq!(ids, [0x0105, 0x0205, 0x0305, 0x0405].map(Uuid::Vendor));
    }
}
