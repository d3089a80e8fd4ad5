//! What an armband does wrong: the part of a scenario that concerns it (`tests/scenario/README.md`).

use serde::Deserialize;

/// How an armband behaves.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// How many times faster than 200 Hz it streams.
    pub pace: f64,
    /// Milliseconds from one connection event to the next: what is due between them comes at once. 0: everything when due.
    pub interval_ms: f64,
    /// The EMG characteristic that a stream starts with.
    pub first_lane: u8,
    /// What follows its last sample.
    pub end: End,
    /// What it does wrong.
    pub steps: Vec<Step>,
}

impl Default for Behaviour {
    fn default() -> Self {
        Self {
            pace: 1.0,
            interval_ms: 0.0,
            first_lane: 0,
            end: End::default(),
            steps: Vec::new(),
        }
    }
}

/// What follows the last sample.
#[derive(Deserialize, Default, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The connection stays.
    #[default]
    Silence,
    /// The armband ends it, and advertises no more.
    Disconnect,
}

/// One thing that the armband does. `at` counts its notifications from 0, sent or not, over all connections.
#[derive(Deserialize, Clone, Debug)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Step {
    /// Notifications that are never sent.
    Drop {
        /// The first.
        at: usize,
        /// How many.
        #[serde(default = "one")]
        count: usize,
    },
    /// One that is sent twice.
    Duplicate {
        /// Which.
        at: usize,
    },
    /// The one after it is sent before it.
    Swap {
        /// Which.
        at: usize,
    },
    /// Something else is sent instead.
    Corrupt {
        /// Which.
        at: usize,
        /// What.
        kind: Corruption,
    },
    /// One is sent late, with all that are due by then.
    Delay {
        /// Which.
        at: usize,
        /// How late.
        ms: u64,
    },
    /// Before it the link is lost.
    Vanish {
        /// Which.
        at: usize,
        /// So long it does not advertise.
        for_ms: u64,
    },
    /// Before it the armband ends the connection.
    Sleep {
        /// Which.
        at: usize,
        /// So long it does not advertise.
        for_ms: u64,
    },
    /// Before it the battery's level falls.
    Battery {
        /// Which.
        at: usize,
        /// Percent.
        percent: u8,
    },
    /// The first connections are closed at once.
    Refuse {
        /// How many.
        count: usize,
    },
    /// Notifications without a subscription, from every connection to its stream: a matter of the Bluetooth stack, so
    /// nothing comes of it here.
    Chatter {
        /// Milliseconds between them.
        #[serde(rename = "ms")]
        _ms: u64,
    },
    /// It is switched off.
    Absent,
}

const fn one() -> usize {
    1
}

/// What is sent instead of a notification.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub enum Corruption {
    /// Its first 9 bytes.
    Short,
    /// Its bytes and 4 more.
    Long,
    /// Its bytes, on another characteristic.
    Foreign,
    /// Nothing that a Bluetooth stack passes on.
    Garbage,
}
