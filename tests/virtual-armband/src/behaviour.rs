//! Faults of an armband: the part of a scenario that concerns it (`tests/scenario/README.md`).

use serde::Deserialize;

/// Behaviour of an armband.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// Factor by which it streams faster than 200 Hz.
    pub pace: f64,
    /// Milliseconds from one connection event to the next: notifications due between them come at once. 0: each comes
    /// when due.
    pub interval_ms: f64,
    /// Event after the last sample.
    pub end: End,
    /// Faults.
    pub steps: Vec<ArmbandFault>,
}

impl Default for Behaviour {
    fn default() -> Self {
        Self {
            pace: 1.0,
            interval_ms: 0.0,
            end: End::default(),
            steps: Vec::new(),
        }
    }
}

impl Behaviour {
    /// Returns an armband's with these faults.
    pub fn with(steps: Vec<ArmbandFault>) -> Self {
        Self {
            steps,
            ..Self::default()
        }
    }
}

/// Event after the last sample.
#[derive(Deserialize, Default, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// Silence: the connection stays.
    #[default]
    Silence,
    /// End of the connection by the armband, which advertises no more.
    Disconnect,
}

/// Fault of the armband. `at` counts its notifications from 0, sent or not, over all connections.
#[derive(Deserialize, Clone, Debug)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ArmbandFault {
    /// Notifications that are never sent.
    Drop {
        /// Number of the first.
        at: usize,
        /// Number of notifications.
        #[serde(default = "one")]
        count: usize,
    },
    /// Other bytes in place of a notification.
    Corrupt {
        /// Number of the notification.
        at: usize,
        /// Kind of the bytes.
        kind: Corruption,
    },
    /// Notification that is sent late, with all that are due by then.
    Delay {
        /// Number of the notification.
        at: usize,
        /// Delay in milliseconds.
        ms: u64,
    },
    /// Loss of the link before a notification.
    Vanish {
        /// Number of the notification.
        at: usize,
        /// Milliseconds in which it does not advertise.
        for_ms: u64,
    },
    /// End of the connection by the armband before a notification.
    Sleep {
        /// Number of the notification.
        at: usize,
        /// Milliseconds in which it does not advertise.
        for_ms: u64,
    },
    /// Fall of the battery's level before a notification.
    Battery {
        /// Number of the notification.
        at: usize,
        /// New level in percent.
        percent: u8,
    },
    /// Refusal: the first connections are closed at once.
    Refuse {
        /// Number of connections.
        count: usize,
    },
    /// Three requests for other connection parameters, on every connection, as a peripheral of the nRF51's time makes them.
    /// Where one is not answered, the armband ends the connection when the next would be due after the last.
    AskParameters {
        /// Milliseconds from the connection to the first request.
        first_ms: u64,
        /// Milliseconds from each to the next.
        every_ms: u64,
    },
    /// EMG that begins so late after every command that sets the mode.
    BeginLate {
        /// Milliseconds.
        ms: u64,
    },
    /// Refusal of all reads of the descriptors that enable notifications.
    HideSubscriptions,
    /// Armband that is switched off.
    Absent,
}

const fn one() -> usize {
    1
}

/// Bytes in place of a notification.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub enum Corruption {
    /// First 9 bytes of the notification.
    Short,
    /// Bytes of the notification and 4 more.
    Long,
    /// Bytes of the notification, on another characteristic.
    Foreign,
}
