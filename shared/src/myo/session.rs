//! The state machine between radio and pipeline.

use super::action::Action;
use super::address::Address;
use super::back_off::BackOff;
use super::characteristic::Found;
use super::command::EmgMode;
use super::counters::Counters;
use super::event::MyoEvent;
use super::packet::FirmwareVersion;
use super::scan::Scan;
use super::sequence::Sequence;
use super::set_up::SetUpStep;
use super::stream_monitor::StreamMonitor;
use crate::units::Millis;

/// Charge up to which the battery counts as low, in percent.
const LOW_BATTERY: u8 = 10;

/// Settings of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Settings {
    /// The only armband to connect to, whichever is bound.
    pub pinned: Option<Address>,
    /// The armband that is bound at first: the only one to connect to.
    pub bound: Option<Address>,
    /// Whether, without either, the armband with the strongest signal is followed, whoever wears it. Otherwise no armband is.
    pub follow_strongest: bool,
    /// The mode that the model was trained with. `Filtered` by default: the vendor recommends it, and
    /// the recordings were made with it.
    pub emg: EmgMode,
    /// Whether the armband's movement is asked for too. Only with the feature `imu`.
    pub imu: bool,
}

/// Phase of a session.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Phase {
    /// No event has come yet.
    Idle,
    /// No armband is to be followed.
    Unbound,
    /// Scanning for an armband.
    Scanning,
    /// Connecting to an armband.
    Connecting,
    /// Discovery, subscriptions, mode.
    SettingUp,
    /// Receiving EMG, or waiting for the first.
    Streaming,
    /// Waiting for the end of a connection that the session closed.
    Disconnecting,
    /// Waiting before the next attempt.
    BackingOff,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum SessionState {
    Idle,
    Unbound,
    Scanning(Scan),
    Connecting {
        since: Millis,
    },
    SettingUp {
        since: Millis,
        step: SetUpStep,
        found: Found,
    },
    Streaming(StreamMonitor),
    Disconnecting {
        since: Millis,
        delay: u32,
    },
    BackingOff {
        since: Millis,
        delay: u32,
    },
}

/// A session with armbands: scan, connect, stream, and again after a disconnection.
///
/// Guarantees: it reads no clock and does no I/O; an event takes bounded work and never panics,
/// whatever its bytes, time and order; events that do not fit the phase are ignored; at most one
/// operation is outstanding; samples are delivered at most once, in order, and never as contiguous
/// across a loss that lanes and arrival times show; `StreamEnded` follows every stream exactly once.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MyoSession {
    /// Settings, with the armband that is bound now.
    settings: Settings,
    state: SessionState,
    pairing: Option<Pairing>,
    pairing_failed: bool,
    /// The EMG of the running stream.
    sequence: Sequence,
    back_off: BackOff,
    counters: Counters,
    armband: Option<Address>,
    battery: Option<u8>,
    firmware: Option<FirmwareVersion>,
}

impl MyoSession {
    /// A session before its first event, which may be any.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            state: SessionState::Idle,
            pairing: None,
            pairing_failed: false,
            sequence: Sequence::new(),
            back_off: BackOff::new(),
            counters: Counters::default(),
            armband: None,
            battery: None,
            firmware: None,
        }
    }

    /// Handles an event at `now` and calls `act` for every action, in order. The answer to an action
    /// needs a call of its own, never from within `act`.
    pub fn handle(&mut self, now: Millis, event: MyoEvent<'_>, act: &mut impl FnMut(Action)) {
        match event {
            MyoEvent::Advertisement {
                address,
                rssi,
                data,
            } => {
                if let SessionState::Scanning(scan) = &mut self.state {
                    if let Some(pairing) = &mut self.pairing {
                        pairing.scan.advertisement(now, address, rssi, data);
                    } else if let Some(address) = scan.advertisement(now, address, rssi, data) {
                        self.connect(now, address, act);
                    }
                }
            }
            MyoEvent::ScanEnded => self.scan_ended(now, act),
            MyoEvent::Connected => self.connected(now, act),
            MyoEvent::ConnectFailed | MyoEvent::Disconnected => self.disconnected(now, event, act),
            MyoEvent::Discovered(_) | MyoEvent::Read(_) | MyoEvent::Done | MyoEvent::Failed => {
                self.operation_answered(now, event, act);
            }
            MyoEvent::Notification {
                characteristic,
                bytes,
            } => self.notification(now, characteristic, bytes, act),
            MyoEvent::Pair => self.pair(now, act),
            MyoEvent::Bind(armband) => self.bind(now, armband, act),
            MyoEvent::Answered | MyoEvent::Tick => {}
        }
        // After the event: an answer that arrives together with the time-out is in time.
        self.handle_time(now, act);
    }

    /// Sets whether the movement is asked for from now on; the armband is told with the next event.
    pub const fn set_imu(&mut self, on: bool) {
        self.settings.imu = on;
    }

    /// The present phase.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        match self.state {
            SessionState::Idle => Phase::Idle,
            SessionState::Unbound => Phase::Unbound,
            SessionState::Scanning(_) => Phase::Scanning,
            SessionState::Connecting { .. } => Phase::Connecting,
            SessionState::SettingUp { .. } => Phase::SettingUp,
            SessionState::Streaming(_) => Phase::Streaming,
            SessionState::Disconnecting { .. } => Phase::Disconnecting,
            SessionState::BackingOff { .. } => Phase::BackingOff,
        }
    }

    /// Event counts so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// The armband of the last connection, or attempt to connect.
    #[must_use]
    pub const fn armband(&self) -> Option<Address> {
        self.armband
    }

    /// Last known charge of the armband in percent; none before this connection's first value.
    #[must_use]
    pub const fn battery(&self) -> Option<u8> {
        self.battery
    }

    /// Whether the charge is known, and 10 % or less.
    #[must_use]
    pub fn battery_is_low(&self) -> bool {
        self.battery.is_some_and(|percent| percent <= LOW_BATTERY)
    }

    /// Firmware version of the armband; none before this connection has read it.
    #[must_use]
    pub const fn firmware(&self) -> Option<FirmwareVersion> {
        self.firmware
    }
}

mod following;
mod transitions;

pub use following::Following;
use following::Pairing;

#[cfg(test)]
pub(super) mod tests;
