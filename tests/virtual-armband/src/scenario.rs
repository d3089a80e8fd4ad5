//! Scenario: what armband, person and board do in a minute that is simulated (`tests/scenario/README.md`).

use std::collections::VecDeque;
use std::iter;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use shared::myo::{Address, AddressKind};
use shared::units::Sample;

use crate::armband::Armband;
use crate::behaviour::{ArmbandFault, Behaviour, End};

/// Address of the wearer's armband: `FA:12:34:56:78:9A`.
pub const ADDRESS: Address = Address {
    kind: AddressKind::Public,
    bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
};
/// Strength of its signal, dBm.
const RSSI: i8 = -50;

/// The part of a scenario that the board's surroundings carry out; a test's file has other keys beside these.
#[derive(Deserialize, Clone, Debug)]
pub struct Scenario {
    /// Seconds that are simulated.
    pub run_seconds: f64,
    /// Behaviour after the armband's last sample.
    #[serde(default)]
    pub end: End,
    /// Factor by which it streams faster than an armband.
    #[serde(default = "as_an_armband")]
    pub pace: f64,
    /// Milliseconds from one connection event to the next: what is due between them comes at once. 0: everything when due.
    #[serde(default)]
    pub interval_ms: f64,
    /// Faults of the armband.
    #[serde(default)]
    pub armband: Vec<ArmbandFault>,
    /// Another armband.
    pub stranger: Option<Stranger>,
    /// Acts of a person.
    #[serde(default)]
    pub person: Vec<Act>,
    /// Fault of the board.
    pub fault: Option<BoardFault>,
    /// Processor time that a packet of two samples takes, in milliseconds.
    #[serde(default)]
    pub packet_ms: f64,
    /// True if the pages of armband and calibration refuse to be written.
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
    /// Returns the behaviour of the wearer's armband.
    pub fn behaviour(&self) -> Behaviour {
        Behaviour {
            pace: self.pace,
            interval_ms: self.interval_ms,
            end: self.end,
            steps: self.armband.clone(),
        }
    }
}

const fn as_an_armband() -> f64 {
    1.0
}

/// Another armband.
#[derive(Deserialize, Clone, Copy, Debug)]
#[serde(deny_unknown_fields)]
pub struct Stranger {
    /// Public address.
    #[serde(deserialize_with = "parsed")]
    pub address: Address,
    /// Strength of its signal, dBm.
    pub rssi: i8,
}

fn parsed<'d, D: Deserializer<'d>>(text: D) -> Result<Address, D::Error> {
    Address::parse(&String::deserialize(text)?).map_err(D::Error::custom)
}

/// Creates the wearer's armband, whose next notification has the number `next`, and a stranger's. It streams the same, so that
/// whoever follows it shows itself by its address alone.
pub fn armbands(
    behaviour: Behaviour,
    stranger: Option<Stranger>,
    samples: Vec<Sample>,
    next: usize,
) -> Vec<Armband> {
    let stranger = stranger.map(|other| Armband::new(other.address, other.rssi, samples.clone()));
    let worn = Armband::new(ADDRESS, RSSI, samples).of_wearer(behaviour, next);
    iter::once(worn).chain(stranger).collect()
}

/// Act of a person, once `at` notifications were sent.
#[derive(Deserialize, Clone, Debug)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Act {
    /// Press of the button.
    Press {
        /// Notifications before.
        at: usize,
        /// Milliseconds until it is released.
        for_ms: u64,
    },
    /// Line that is sent.
    Send {
        /// Notifications before.
        at: usize,
        /// Milliseconds from then on, or from the act before.
        #[serde(default)]
        after_ms: u64,
        /// Command without `$`, checksum and line end.
        command: String,
    },
    /// Bytes that are sent.
    SendBytes {
        /// Notifications before.
        at: usize,
        /// Text of which each character is a byte.
        text: String,
        /// Number of times that the text is sent.
        #[serde(default = "once")]
        times: usize,
    },
    /// Installation of a model: begins, and sends the blocks that the board asks for.
    Install {
        /// Notifications before.
        at: usize,
        /// Number of blocks after which the line is pulled, in the middle of the next block and for a second.
        pulled_after: Option<u32>,
    },
}

const fn once() -> usize {
    1
}

impl Act {
    /// Returns the number of notifications before it.
    pub const fn at(&self) -> usize {
        match self {
            Self::Press { at, .. }
            | Self::Send { at, .. }
            | Self::SendBytes { at, .. }
            | Self::Install { at, .. } => *at,
        }
    }

    /// Returns the microseconds that it waits when those were sent and the act before is done.
    const fn after_us(&self) -> u64 {
        match self {
            Self::Send { after_ms, .. } => *after_ms * 1000,
            _ => 0,
        }
    }
}

/// Frames a line of any body, with its checksum.
pub fn framed(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

/// Acts that are not done yet: a person does one thing after the other.
#[derive(Debug)]
pub struct Acts {
    left: VecDeque<Act>,
    /// Time from which on the next act waits.
    waits_from_us: Option<u64>,
}

impl FromIterator<Act> for Acts {
    fn from_iter<I: IntoIterator<Item = Act>>(acts: I) -> Self {
        Self {
            left: acts.into_iter().collect(),
            waits_from_us: None,
        }
    }
}

impl Acts {
    /// Takes the next act, if it is due when so many notifications were sent.
    pub fn next_due(&mut self, now_us: u64, sent: usize) -> Option<Act> {
        let act = self.left.front().filter(|act| act.at() <= sent)?;
        let since = *self.waits_from_us.get_or_insert(now_us);
        if now_us < since + act.after_us() {
            return None;
        }
        self.waits_from_us = None;
        self.left.pop_front()
    }
}

/// Fault of the board, after its third label.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub enum BoardFault {
    /// The task that writes lines waits forever.
    TaskStops,
    /// Panic of a task.
    Panic,
    /// A task loops and never returns to the executor.
    ExecutorStops,
    /// The inference takes 400 ms for one packet.
    InferencePauses,
    /// Nothing more comes from the Bluetooth stack.
    RadioStops,
    /// Nothing comes from the Bluetooth stack, from the start on.
    RadioNeverAnswers,
}
