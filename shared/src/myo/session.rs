//! The state machine between a radio and the pipeline.

use super::action::Action;
use super::address::Address;
use super::back_off::BackOff;
use super::characteristic::Found;
use super::command::EmgMode;
use super::counters::Counters;
use super::event::Event;
use super::packet::FirmwareVersion;
use super::scan::Scan;
use super::sequence::Sequence;
use super::set_up::Step;
use super::stream::Stream;
use crate::units::Millis;

/// Charge up to which the battery counts as low, in percent.
const LOW_BATTERY: u8 = 10;

/// What a session is asked to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Settings {
    /// The only armband to connect to; any, the strongest first, where none is named.
    pub pinned: Option<Address>,
    /// The mode that the model was trained in. `Filtered` unless told otherwise: the vendor
    /// recommends it, and the recordings were made in it.
    pub emg: EmgMode,
}

/// What a session is doing.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Phase {
    /// Nothing: no event came yet.
    Idle,
    /// Looking for an armband.
    Scanning,
    /// Connecting to one.
    Connecting,
    /// Asking what it offers, subscribing, setting its mode.
    SettingUp,
    /// Receiving EMG, or waiting for the first.
    Streaming,
    /// Waiting for the connection that it gave up to be gone.
    Disconnecting,
    /// Waiting for the next attempt.
    BackingOff,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum State {
    Idle,
    Scanning(Scan),
    Connecting {
        since: Millis,
    },
    SettingUp {
        since: Millis,
        step: Step,
        found: Found,
    },
    Streaming(Stream),
    Disconnecting {
        since: Millis,
        rest: u32,
    },
    BackingOff {
        since: Millis,
        rest: u32,
    },
}

/// A session with an armband, from scan to scan, for as long as the device runs.
///
/// Promises: it reads no clock and does no I/O; an event takes bounded work and never panics,
/// whatever its bytes, its time and its order; events that do not fit are ignored; at most one
/// operation is outstanding; samples are delivered at most once, in order, and never as contiguous
/// across a loss that lanes and times can show; `StreamEnded` follows every stream exactly once.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MyoSession {
    settings: Settings,
    state: State,
    /// The EMG of the stream under way.
    sequence: Sequence,
    back_off: BackOff,
    counters: Counters,
    armband: Option<Address>,
    battery: Option<u8>,
    firmware: Option<FirmwareVersion>,
}

impl MyoSession {
    /// A session that starts with its first event, whichever that is.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            state: State::Idle,
            sequence: Sequence::new(),
            back_off: BackOff::new(),
            counters: Counters::default(),
            armband: None,
            battery: None,
            firmware: None,
        }
    }

    /// Hears of an event at `now` and says what to do, in order. Actions that are answered at once
    /// are answered by a later call, never from within `act`.
    pub fn handle(&mut self, now: Millis, event: Event<'_>, act: &mut impl FnMut(Action)) {
        match event {
            Event::Advertisement {
                address,
                rssi,
                data,
            } => {
                if let State::Scanning(scan) = &mut self.state
                    && let Some(address) = scan.hear(now, address, rssi, data)
                {
                    self.connect(now, address, act);
                }
            }
            Event::ScanEnded => self.scan_ended(now, act),
            Event::Connected => self.connected(now, act),
            Event::ConnectFailed | Event::Disconnected => self.gone(now, event, act),
            Event::Discovered(_) | Event::Read(_) | Event::Done | Event::Failed => {
                self.answered(now, event, act);
            }
            Event::Notification {
                characteristic,
                bytes,
            } => self.notified(now, characteristic, bytes, act),
            Event::Tick => {}
        }
        // After the event: an answer that beats a tick to it is in time.
        self.keep_time(now, act);
    }

    /// What it is doing.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        match self.state {
            State::Idle => Phase::Idle,
            State::Scanning(_) => Phase::Scanning,
            State::Connecting { .. } => Phase::Connecting,
            State::SettingUp { .. } => Phase::SettingUp,
            State::Streaming(_) => Phase::Streaming,
            State::Disconnecting { .. } => Phase::Disconnecting,
            State::BackingOff { .. } => Phase::BackingOff,
        }
    }

    /// What it has lived through.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// Which armband it connected to, or tried to, last.
    #[must_use]
    pub const fn armband(&self) -> Option<Address> {
        self.armband
    }

    /// Charge of the armband in percent, as last told; none of this connection's yet.
    #[must_use]
    pub const fn battery(&self) -> Option<u8> {
        self.battery
    }

    /// Whether the charge is known to be 10 % or less.
    #[must_use]
    pub fn battery_is_low(&self) -> bool {
        self.battery.is_some_and(|percent| percent <= LOW_BATTERY)
    }

    /// Firmware of the armband; none of this connection's yet.
    #[must_use]
    pub const fn firmware(&self) -> Option<FirmwareVersion> {
        self.firmware
    }
}

mod transitions;

#[cfg(test)]
mod tests;
