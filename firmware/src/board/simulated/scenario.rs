//! Acts of armband and person: the part of a scenario that the board's surroundings carry out.

use serde::Deserialize;
use virtual_armband::{ArmbandFault, Behaviour, End};

/// A scenario, as `tests/scenario/README.md` describes its file. Other keys are for the test that checks the outcome.
#[derive(Deserialize)]
pub struct Scenario {
    /// Seconds that are simulated.
    pub run_seconds: f64,
    /// Behaviour after the armband's last sample.
    #[serde(default)]
    pub end: End,
    /// Factor by which it streams faster than an armband.
    #[serde(default = "once")]
    pub pace: f64,
    /// Milliseconds from one connection event to the next: what is due between them comes at once. 0: everything when due.
    #[serde(default)]
    pub interval_ms: f64,
    /// The EMG characteristic that a stream starts with.
    #[serde(default)]
    pub first_lane: u8,
    #[serde(default)]
    pub armband: Vec<ArmbandFault>,
    pub stranger: Option<Stranger>,
    #[serde(default)]
    pub person: Vec<Act>,
    /// Fault of the board.
    pub fault: Option<Fault>,
    /// Processor time that a packet of two samples takes, in milliseconds.
    #[serde(default)]
    pub packet_ms: f64,
    /// Whether the pages of armband and calibration refuse to be written.
    #[serde(default)]
    pub page_fails: bool,
    /// Operations of flash, counted from 1 at each start, in the middle of which power fails; it comes back at once.
    #[serde(default)]
    pub power_fails_at: Vec<u32>,
    /// Part of each that is done, in percent; 50 by default.
    #[serde(default)]
    pub power_fails_done: Vec<u32>,
}

impl Scenario {
    pub fn behaviour(&self) -> Behaviour {
        Behaviour {
            pace: self.pace,
            interval_ms: self.interval_ms,
            first_lane: self.first_lane,
            end: self.end,
            steps: self.armband.clone(),
        }
    }
}

const fn once() -> f64 {
    1.0
}

const fn one() -> usize {
    1
}

#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
pub struct Stranger {
    /// A public one.
    pub address: String,
    /// Strength of its signal; the armband's own is -50 dBm.
    pub rssi: i8,
}

/// Act of a person, once `at` notifications were sent.
#[derive(Deserialize, Clone)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Act {
    Press {
        at: usize,
        for_ms: u64,
    },
    Send {
        at: usize,
        /// Milliseconds from then on, or from the act before.
        #[serde(default)]
        after_ms: u64,
        /// Command without `$`, checksum and line end.
        command: String,
    },
    SendBytes {
        at: usize,
        /// Bytes as text, one per character.
        text: String,
        #[serde(default = "one")]
        times: usize,
    },
    /// Installs a model: begins, and sends the blocks that the board asks for.
    Install {
        at: usize,
        /// Numbers of blocks after which the line is pulled, once for each.
        #[serde(default)]
        pulled_after: Vec<u32>,
        /// Bytes of the block after them that have passed by then, 40 by default; if it is all of them, its answer is
        /// not heard.
        #[serde(default)]
        pulled_byte: Vec<usize>,
        /// Milliseconds until it is plugged in again.
        #[serde(default = "a_second")]
        pulled_ms: u64,
    },
}

const fn a_second() -> u64 {
    1000
}

impl Act {
    pub const fn at(&self) -> usize {
        match self {
            Self::Press { at, .. }
            | Self::Send { at, .. }
            | Self::SendBytes { at, .. }
            | Self::Install { at, .. } => *at,
        }
    }

    /// Microseconds that it waits when those were sent and the act before is done.
    pub const fn after_us(&self) -> u64 {
        match self {
            Self::Send { after_ms, .. } => *after_ms * 1000,
            _ => 0,
        }
    }
}

/// Fault of the board, after its third label.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The task that writes lines waits forever.
    TaskStops,
    Panic,
    /// A function that calls itself without end: the guard of the stack notices.
    Recursion,
    /// A task loops and never returns to the executor.
    ExecutorStops,
    /// The inference loops and never returns.
    InferenceLoops,
    /// The inference takes 400 ms for one packet.
    InferencePauses,
    /// Nothing more comes from the Bluetooth stack.
    RadioStops,
    /// Nothing comes from the Bluetooth stack, from the start on.
    RadioNeverAnswers,
}
