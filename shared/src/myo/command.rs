//! What the armband is told, as bytes for its Command characteristic.

use super::action::Payload;

/// How the armband treats the EMG before it sends it. A model must be fed in the mode that it was
/// trained in: the signals differ by the mains filter.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum EmgMode {
    /// Mains interference removed, not rectified: the mode that the vendor recommends.
    #[default]
    Filtered,
    /// As the electrodes give it.
    Raw,
}

/// A command. IMU and gestures are never wanted: their notifications would take air time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Command {
    /// Stream EMG at 200 Hz; IMU and classifier off. Forgotten by the armband at a disconnect.
    SetMode(EmgMode),
    /// Stay connected through inactivity; without it the link is dropped after about 30 s, EMG or
    /// not. Forgotten at a disconnect as well.
    NeverSleep,
}

impl Command {
    /// The bytes to write: command, payload length, payload.
    #[must_use]
    pub const fn payload(self) -> Payload {
        match self {
            Self::SetMode(EmgMode::Filtered) => Payload::new([0x01, 3, 2, 0, 0]),
            Self::SetMode(EmgMode::Raw) => Payload::new([0x01, 3, 3, 0, 0]),
            Self::NeverSleep => Payload::new([0x09, 1, 1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_the_vendors_bytes() {
        let bytes = |command: Command| command.payload();
        let set_mode = |mode| bytes(Command::SetMode(mode));
        assert_eq!(set_mode(EmgMode::Filtered).as_slice(), [1, 3, 2, 0, 0]);
        assert_eq!(set_mode(EmgMode::Raw).as_slice(), [1, 3, 3, 0, 0]);
        assert_eq!(bytes(Command::NeverSleep).as_slice(), [9, 1, 1]);
    }
}
