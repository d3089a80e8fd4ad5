//! Commands to the armband, as bytes for its Command characteristic.

use super::action::Payload;

/// Processing of EMG in the armband. A model needs the mode that it was trained with:
/// the signals differ by the mains filter.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum EmgMode {
    /// Mains interference removed, not rectified: the mode recommended by the vendor.
    #[default]
    Filtered,
    /// Unfiltered.
    Raw,
}

/// A command. The gesture classifier stays off: its notifications would take air time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum ArmbandCommand {
    /// Stream EMG at 200 Hz, and the IMU at 50 Hz or not at all. Lost at a disconnection.
    SetMode(EmgMode, bool),
    /// Never sleep: without it the armband drops the link after about 30 s of inactivity, even while
    /// EMG streams. Lost at a disconnection.
    NeverSleep,
}

impl ArmbandCommand {
    /// The bytes to write: command, payload length, payload.
    #[must_use]
    pub(super) const fn payload(self) -> Payload {
        match self {
            Self::SetMode(EmgMode::Filtered, imu) => Payload::new([0x01, 3, 2, imu as u8, 0]),
            Self::SetMode(EmgMode::Raw, imu) => Payload::new([0x01, 3, 3, imu as u8, 0]),
            Self::NeverSleep => Payload::new([0x09, 1, 1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_the_vendors_bytes() {
        let bytes = |command: ArmbandCommand| command.payload();
        let set_mode = |mode, imu| bytes(ArmbandCommand::SetMode(mode, imu));
        let filtered = |imu| set_mode(EmgMode::Filtered, imu);
        assert_eq!(filtered(false).as_slice(), [1, 3, 2, 0, 0]);
        assert_eq!(filtered(true).as_slice(), [1, 3, 2, 1, 0]);
        assert_eq!(set_mode(EmgMode::Raw, false).as_slice(), [1, 3, 3, 0, 0]);
        assert_eq!(bytes(ArmbandCommand::NeverSleep).as_slice(), [9, 1, 1]);
    }
}
