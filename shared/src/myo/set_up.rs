//! The steps between connection and stream.

use super::action::Action;
use super::characteristic::{Characteristic, Found};
use super::command::{ArmbandCommand, EmgMode};
use super::event::MyoEvent;
use super::lane::Lane;
use super::packet::{FirmwareVersion, parse_battery};

/// A step of the set-up: one operation. The mode is set last, since EMG then shares air time and
/// queues with the responses. The IMU comes later: see [`StreamMonitor`](super::stream_monitor::StreamMonitor).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum SetUpStep {
    Discover,
    ReadFirmware,
    ReadBattery,
    SubscribeEmg(Lane),
    SubscribeBattery,
    NeverSleep,
    SetMode,
}

/// Answer of an event to a step.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Response {
    /// No answer to this step.
    None,
    Done,
    Found(Found),
    Firmware(FirmwareVersion),
    Battery(u8),
    Failed,
    /// Failed, because a value was too short.
    Malformed,
    /// The armband's firmware is not supported.
    Unsupported,
}

impl SetUpStep {
    pub(super) const fn action(self, emg: EmgMode) -> Action {
        match self {
            Self::Discover => Action::Discover,
            Self::ReadFirmware => Action::Read(Characteristic::FirmwareVersion),
            Self::ReadBattery => Action::Read(Characteristic::BatteryLevel),
            Self::SubscribeEmg(lane) => Action::Subscribe(Characteristic::Emg(lane)),
            Self::SubscribeBattery => Action::Subscribe(Characteristic::BatteryLevel),
            Self::NeverSleep => write(ArmbandCommand::NeverSleep),
            Self::SetMode => write(ArmbandCommand::SetMode(emg, false)),
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

    /// Whether the stream works without it.
    pub(super) const fn is_optional(self) -> bool {
        matches!(self, Self::ReadBattery | Self::SubscribeBattery)
    }

    /// The answer of `event` to this step.
    pub(super) fn response(self, event: MyoEvent<'_>) -> Response {
        match (self, event) {
            (_, MyoEvent::Failed) => Response::Failed,
            (Self::Discover, MyoEvent::Discovered(found)) if found.is_sufficient() => {
                Response::Found(found)
            }
            (Self::Discover, MyoEvent::Discovered(_)) => Response::Failed,
            (Self::ReadFirmware, MyoEvent::Read(bytes)) => match FirmwareVersion::parse(bytes) {
                Ok(version) if version.is_supported() => Response::Firmware(version),
                Ok(_) => Response::Unsupported,
                Err(_) => Response::Malformed,
            },
            (Self::ReadBattery, MyoEvent::Read(bytes)) => {
                parse_battery(bytes).map_or(Response::Malformed, Response::Battery)
            }
            (
                Self::SubscribeEmg(_) | Self::SubscribeBattery | Self::NeverSleep | Self::SetMode,
                MyoEvent::Done,
            ) => Response::Done,
            _ => Response::None,
        }
    }
}

/// A write of `command`.
pub(super) const fn write(command: ArmbandCommand) -> Action {
    Action::Write(Characteristic::Command, command.payload())
}
