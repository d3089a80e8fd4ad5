//! Answers matched with commands: for a program on the PC, which may read late answers to others.

use super::{Accepted, Answer, Refusal};
use crate::hid::HidCommand;
use crate::myo::Following;
use crate::uart_line::calibration::CalibrateCommand;
use crate::uart_line::command::{AlignCommand, BindCommand, Command};
use crate::uart_line::gate::GateCommand;
use crate::uart_line::lock::LockCommand;

impl Answer<'_> {
    /// Whether this can be the answer to a command.
    ///
    /// A line has no number of a request, so the content is compared: kind, and what was asked for where the answer says it
    /// again. Answers to two questions of one kind are not told apart, nor two alignments that are set.
    #[must_use]
    pub fn answers(&self, command: Command) -> bool {
        match (command, self) {
            (_, Self::Refused(refusal)) => refusal.refuses(command),
            (Command::Identify, Self::Identity(_))
            | (Command::Battery, Self::Battery(_))
            | (Command::Counters, Self::Counts(_))
            | (Command::Align(AlignCommand::State), Self::Alignment(_))
            | (Command::Gate(GateCommand::State), Self::Gate(_))
            | (Command::Bind(BindCommand::State), Self::Binding(_))
            | (Command::Calibrate(_), Self::Calibration(..))
            | (Command::Install(_) | Command::Block(..), Self::Install(_)) => true,
            (Command::Align(asked), Self::Align(accepted)) => {
                Accepted::of(asked) == Some(*accepted)
            }
            (Command::Raw(asked), Self::Raw(on))
            | (Command::Imu(asked), Self::Imu(on))
            | (Command::Strength(asked), Self::Strength(on)) => asked == *on,
            (Command::Gate(GateCommand::Set(asked)), Self::Gate(gate)) => asked == *gate,
            (Command::Lock(asked), Self::Lock(lock)) => match asked {
                LockCommand::Set(times) => lock.is_some_and(|lock| lock.times == times),
                LockCommand::Off => lock.is_none(),
                LockCommand::Hold { is_locked } => lock.is_none_or(|lock| lock.locked == is_locked),
                LockCommand::State => true,
            },
            (Command::Hid(asked), Self::Hid(settings)) => settings.after(asked) == *settings,
            (Command::Bind(asked), Self::Binding(binding)) => match (asked, binding.following) {
                (BindCommand::Begin, Following::Pairing)
                | (BindCommand::Forget, Following::Nobody | Following::Strongest) => true,
                // The line does not say which kind of address it is.
                (BindCommand::Set(asked), Following::Bound(armband)) => {
                    asked.bytes == armband.bytes
                }
                _ => false,
            },
            _ => false,
        }
    }
}

impl Refusal {
    /// Whether a command can be refused so.
    #[must_use]
    pub const fn refuses(self, command: Command) -> bool {
        match self {
            // Of any line.
            Self::TooLong | Self::Frame | Self::Checksum(_) | Self::Unknown | Self::Arguments => {
                true
            }
            Self::NoModel => match command {
                Command::Align(align) => !matches!(align, AlignCommand::State),
                Command::Calibrate(own) => !matches!(own, CalibrateCommand::State),
                _ => matches!(command, Command::Bind(_) | Command::Gate(_)),
            },
            Self::NoStream => matches!(
                command,
                Command::Align(AlignCommand::Begin(_))
                    | Command::Calibrate(CalibrateCommand::Begin { .. })
            ),
            Self::BuiltIn => match command {
                Command::Bind(bind) => !matches!(bind, BindCommand::State),
                _ => false,
            },
            Self::Busy => !matches!(
                command,
                Command::Identify
                    | Command::Battery
                    | Command::Counters
                    | Command::Raw(_)
                    | Command::Imu(_)
                    | Command::Strength(_)
            ),
            Self::NoRoom => matches!(command, Command::Imu(true)),
            Self::Length => matches!(command, Command::Install(_)),
            Self::Block | Self::NotBegun | Self::Model => matches!(command, Command::Block(..)),
            Self::Flash => match command {
                Command::Hid(own) => !matches!(own, HidCommand::State),
                _ => matches!(command, Command::Block(..)),
            },
        }
    }
}
