//! Schedule of the commands to a board.

use shared::myo::Following;
use shared::uart_line::calibration::{CalibrateCommand, CalibrationState};
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::units::Millis;

/// Period of the questions for the board's losses.
const COUNTERS_MS: u32 = 2_000;
/// Period of the questions for identity, binding and alignment: the battery changes slowly, and a line may have been
/// lost.
pub const IDENTIFY_MS: u32 = 10_000;
/// Period of the questions for the binding while the board follows no armband.
const UNBOUND_MS: u32 = 1_000;
/// Period of the questions for a calibration in progress: a cue is shown that late.
const CALIBRATES_MS: u32 = 200;
/// Time without samples after which the raw stream is asked for again: the board may have restarted.
const RAW_MS: u32 = 1_000;

/// Time of the last command of each kind.
#[derive(Debug, Default)]
pub struct CommandSchedule {
    raw: Option<Millis>,
    counters: Option<Millis>,
    identify: Option<Millis>,
    align: Option<Millis>,
    bind: Option<Millis>,
    calibrate: Option<Millis>,
    is_unbound: bool,
    is_calibrating: bool,
    /// Whether movement is wanted, and is to be asked for now.
    imu: (bool, bool),
}

impl CommandSchedule {
    /// Schedule before the first command; with movement or without.
    pub fn new(imu: bool) -> Self {
        Self {
            imu: (imu, false),
            ..Self::default()
        }
    }

    /// Returns the next command that is due; to be called until no command is. `samples` is the time of the last samples.
    pub fn command(&mut self, now: Millis, samples: Option<Millis>) -> Option<Command> {
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
        let calibration = if self.is_calibrating {
            CALIBRATES_MS
        } else {
            IDENTIFY_MS
        };
        if due(self.calibrate, calibration) {
            self.calibrate = Some(now);
            return Some(Command::Calibrate(CalibrateCommand::State));
        }
        if due(samples, RAW_MS) && due(self.raw, RAW_MS) {
            self.raw = Some(now);
            self.imu.1 = self.imu.0;
            return Some(Command::Raw(true));
        }
        if std::mem::take(&mut self.imu.1) {
            return Some(Command::Imu(true));
        }
        if due(self.counters, COUNTERS_MS) {
            self.counters = Some(now);
            return Some(Command::Counters);
        }
        None
    }

    /// Records how far a calibration is.
    pub const fn calibrates(&mut self, state: CalibrationState) {
        use CalibrationState::{Judging, Keeping, Teaching};
        self.is_calibrating = matches!(state, Teaching | Judging | Keeping);
    }

    /// Asks for alignment, binding and calibration again after a restart of the board.
    pub fn restart(&mut self) {
        self.align = None;
        self.bind = None;
        self.calibrate = None;
    }

    /// Records which armband the board follows.
    pub fn follows(&mut self, following: Following) {
        self.is_unbound = matches!(following, Following::Nobody | Following::Pairing);
    }
}
