//! What is done between the connection and the stream, a step at a time.

use super::action::Action;
use super::characteristic::{Characteristic, Found};
use super::command::{Command, EmgMode};
use super::event::Event;
use super::lane::Lane;
use super::packet::{FirmwareVersion, parse_battery};

/// A step, each one operation. The mode comes last: once EMG streams, answers share the air and
/// the queues with it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Step {
    Discover,
    ReadFirmware,
    ReadBattery,
    SubscribeEmg(Lane),
    SubscribeBattery,
    NeverSleep,
    SetMode,
}

/// What an event means to a step.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Answer {
    /// Not its answer.
    None,
    Done,
    Found(Found),
    Firmware(FirmwareVersion),
    Battery(u8),
    Failed,
    /// Failed, because a value was too short.
    Malformed,
    /// This armband will never do.
    Refused,
}

impl Step {
    pub(super) const fn action(self, emg: EmgMode) -> Action {
        match self {
            Self::Discover => Action::Discover,
            Self::ReadFirmware => Action::Read(Characteristic::FirmwareVersion),
            Self::ReadBattery => Action::Read(Characteristic::BatteryLevel),
            Self::SubscribeEmg(lane) => Action::Subscribe(Characteristic::Emg(lane)),
            Self::SubscribeBattery => Action::Subscribe(Characteristic::BatteryLevel),
            Self::NeverSleep => write(Command::NeverSleep),
            Self::SetMode => write(Command::SetMode(emg)),
        }
    }

    /// The step after this one; none after the last. An armband without a battery skips two.
    pub(super) const fn next(self, found: Found) -> Option<Self> {
        let battery = found.contains(Characteristic::BatteryLevel);
        Some(match self {
            Self::Discover => Self::ReadFirmware,
            Self::ReadFirmware if battery => Self::ReadBattery,
            Self::ReadFirmware | Self::ReadBattery => Self::SubscribeEmg(Lane::ALL[0]),
            Self::SubscribeEmg(lane) => match Lane::new(lane.number() + 1) {
                Some(lane) => Self::SubscribeEmg(lane),
                None if battery => Self::SubscribeBattery,
                None => Self::NeverSleep,
            },
            Self::SubscribeBattery => Self::NeverSleep,
            Self::NeverSleep => Self::SetMode,
            Self::SetMode => return None,
        })
    }

    /// Whether a stream needs no success of it.
    pub(super) const fn is_optional(self) -> bool {
        matches!(self, Self::ReadBattery | Self::SubscribeBattery)
    }

    /// What `event` means to this step.
    pub(super) fn answer(self, event: Event<'_>) -> Answer {
        match (self, event) {
            (_, Event::Failed) => Answer::Failed,
            (Self::Discover, Event::Discovered(found)) if found.suffices() => Answer::Found(found),
            (Self::Discover, Event::Discovered(_)) => Answer::Failed,
            (Self::ReadFirmware, Event::Read(bytes)) => match FirmwareVersion::parse(bytes) {
                Ok(version) if version.is_supported() => Answer::Firmware(version),
                Ok(_) => Answer::Refused,
                Err(_) => Answer::Malformed,
            },
            (Self::ReadBattery, Event::Read(bytes)) => {
                parse_battery(bytes).map_or(Answer::Malformed, Answer::Battery)
            }
            (
                Self::SubscribeEmg(_) | Self::SubscribeBattery | Self::NeverSleep | Self::SetMode,
                Event::Done,
            ) => Answer::Done,
            _ => Answer::None,
        }
    }
}

/// A write of `command`.
pub(super) const fn write(command: Command) -> Action {
    Action::Write(Characteristic::Command, command.payload())
}
