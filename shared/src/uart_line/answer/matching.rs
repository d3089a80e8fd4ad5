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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hid;
    use crate::installation::{Block, InstallationProgress, Transfer};
    use crate::myo::Address;
    use crate::stream::alignment::{Alignment, Arm};
    use crate::stream::lock::LockTimes;
    use crate::stream::smoother::Gate;
    use crate::uart_line::answer::{Binding, Counts, Identity};
    use crate::uart_line::lock::Locking;

    #[test]
    #[rustfmt::skip]
    fn an_answer_is_told_from_those_to_other_commands() {
        use Answer::{Alignment as Placed, Gate as Of, Raw, Refused};
        use Command::{Align, Bind, Counters, Gate as Set, Hid, Identify, Install, Lock};
        let identity = Answer::Identity(Identity {
            version: "0.1.0", revision: "0", image: "test", model: Some(7), armband: None, firmware: None, battery: None,
        });
        let [mine, other] = ["FA:12:34:56:78:9A", "FA:12:34:56:78:9B"].map(|text| Address::parse(text).unwrap());
        let binding = |following| Answer::Binding(Binding { following, is_kept: true });
        let [bound, bound_to_other] = [mine, other].map(|armband| binding(Following::Bound(armband)));
        let [nobody, pairing, strongest] = [Following::Nobody, Following::Pairing, Following::Strongest].map(binding);
        // The line does not say which alignment is set.
        let turned = Alignment::new(3, true);
        let [begin, cancel, set] = [AlignCommand::Begin(Arm::Unknown), AlignCommand::Cancel, AlignCommand::Set(turned)].map(Align);
        let [begun, cancelled, was_set] = [Accepted::Begin, Accepted::Cancel, Accepted::Set].map(Answer::Align);
        let refusals = [
            Refusal::NoModel, Refusal::NoStream, Refusal::BuiltIn, Refusal::Length,
            Refusal::Block, Refusal::NotBegun, Refusal::Model, Refusal::Flash,
        ].map(Refused);
        let [no_model, no_stream, built_in, length, _, not_begun, model, flash] = refusals;
        let next = |block| Answer::Install(InstallationProgress::Next(block));
        let counts = Answer::Counts(Counts::default());
        let lock = |locked| Answer::Lock(Some(Locking { times: LockTimes::USUAL, locked }));
        let gate = |entry| Gate { entry: Some(entry), other: None, reaction: None };
        let off = Answer::Hid(hid::Settings::OFF);
        let switch = HidCommand::Switch(true);
        let transfer = Transfer { length: 84_729, checksum: 7 };
        let table: [(Command, &[Answer<'_>], Answer<'_>); 21] = [
            (Identify, &refusals, identity),
            (Counters, &refusals, counts),
            (Command::Raw(true), &refusals, Raw(true)),
            (Identify, &[counts, next(1), nobody], identity),
            (Command::Raw(true), &[Raw(false)], Raw(true)),
            (begin, &[cancelled, was_set, Placed(turned), built_in, flash, length], begun),
            (cancel, &[begun, was_set, no_stream, built_in], cancelled),
            (set, &[begun, cancelled, Placed(turned)], was_set),
            (Align(AlignCommand::State), &[begun, was_set, no_stream], Placed(turned)),
            (Bind(BindCommand::Begin), &[bound, nobody], pairing),
            (Bind(BindCommand::Set(mine)), &[nobody, pairing, bound_to_other], bound),
            (Bind(BindCommand::Forget), &[pairing, bound], nobody),
            (Bind(BindCommand::Forget), &[bound], strongest),
            (Bind(BindCommand::State), &[counts, no_stream], bound),
            (Set(GateCommand::Set(gate(150))), &[Of(gate(50)), no_stream, built_in, flash], Of(gate(150))),
            (Set(GateCommand::State), &[nobody, identity], Of(gate(1))),
            (Lock(LockCommand::Set(LockTimes::USUAL)), &[Answer::Lock(None), counts, no_model], lock(true)),
            (Lock(LockCommand::Hold { is_locked: false }), &[lock(true)], lock(false)),
            (Hid(switch), &[off, counts], Answer::Hid(hid::Settings::OFF.after(switch))),
            (Install(transfer), &[counts, not_begun, no_stream, model], next(0)),
            (Command::Block(0, Block::ERASED), &[length, Raw(true)], next(64)),
        ];
        for (command, others, own) in table {
            assert!(own.answers(command), "{command:?} {own:?}");
            for other in others {
                assert!(!other.answers(command), "{command:?} {other:?}");
            }
        }
    }
}
