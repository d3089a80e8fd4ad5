//! Which command a board is sent next, and when.

use shared::myo::Following;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::units::Millis;

/// How often the board is asked for its losses.
const COUNTERS_MS: u32 = 2_000;
/// How often it is asked what it is, whom it follows and how it is aligned: the battery changes slowly, and a line may have
/// been lost.
pub(super) const IDENTIFY_MS: u32 = 10_000;
/// How often a board that follows nobody is asked whether it does now.
const UNBOUND_MS: u32 = 1_000;
/// Without samples for so long the raw stream is asked for again: the board may have restarted.
const RAW_MS: u32 = 1_000;

/// When each was asked for last.
#[derive(Debug, Default)]
pub(super) struct Schedule {
    raw: Option<Millis>,
    counters: Option<Millis>,
    identify: Option<Millis>,
    align: Option<Millis>,
    bind: Option<Millis>,
    is_unbound: bool,
}

impl Schedule {
    /// The next command that is due; to be asked until there is none. `samples` is when the last ones came.
    pub(super) fn command(&mut self, now: Millis, samples: Option<Millis>) -> Option<Command> {
        let due = |last: Option<Millis>, period| {
            last.is_none_or(|last| now.elapsed_since(last) >= period)
        };
        if due(self.identify, IDENTIFY_MS) {
            self.identify = Some(now);
            return Some(Command::Identify);
        }
        if due(self.align, IDENTIFY_MS) {
            self.align = Some(now);
            return Some(Command::Align(AlignCommand::State));
        }
        let binding = if self.is_unbound {
            UNBOUND_MS
        } else {
            IDENTIFY_MS
        };
        if due(self.bind, binding) {
            self.bind = Some(now);
            return Some(Command::Bind(BindCommand::State));
        }
        if due(samples, RAW_MS) && due(self.raw, RAW_MS) {
            self.raw = Some(now);
            return Some(Command::Raw(true));
        }
        if due(self.counters, COUNTERS_MS) {
            self.counters = Some(now);
            return Some(Command::Counters);
        }
        None
    }

    /// The board restarted: alignment and armband may be others.
    pub(super) fn restart(&mut self) {
        self.align = None;
        self.bind = None;
    }

    /// The board says which armband it follows.
    pub(super) fn follows(&mut self, following: Following) {
        self.is_unbound = matches!(following, Following::Nobody | Following::Pairing);
    }
}
