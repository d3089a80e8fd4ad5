//! The outputs' state: a label with `valid` high, or relax with `valid` low (the safe state).
//!
//! The device starts in the safe state and enters it again on each [`Cause`]. It leaves the safe state
//! only with a label from a full window of contiguous samples; after a refused model it never does.
//! Time is an argument and must not run backwards: an instant before the last sample looks like a long
//! silence, and enters the safe state.

use crate::intent::Intent;
use crate::names::names;
use crate::units::Millis;

/// Milliseconds without a sample after which the stream counts as silent.
pub const SILENCE_MS: u32 = 200;

names! {
    /// Why the device is in its safe state.
    pub enum Cause {
        /// Power on, button or debugger.
        Boot = "boot",
        /// Reset by the watchdog.
        Watchdog = "watchdog",
        /// Reset by the program, after the stack had grown too deep.
        StackOverflow = "stack",
        /// The model file was refused. Lasts until the next reset, or until another one is installed.
        ModelRefused = "model-refused",
        /// The armband was disconnected.
        Disconnected = "disconnected",
        /// No sample for 200 ms.
        Silence = "silence",
        /// More consecutive samples were lost than are filled in.
        Gap = "gap",
        /// More samples of a window were lost, each gap short, than may be filled in.
        Losses = "losses",
        /// The inference did not run, and hardware cleared the pins.
        Stalled = "stalled",
        /// Another model is being installed, or the model calibrated.
        Installation = "installation",
        /// Labels are locked until a sign.
        Locked = "locked",
    }
}

/// State of the outputs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Status {
    /// `valid` high, and this label.
    Valid(Intent),
    /// `valid` low, and the label relax.
    Safe(Cause),
}

impl Status {
    /// The level of the `valid` pin.
    #[must_use]
    pub const fn valid(self) -> bool {
        matches!(self, Self::Valid(_))
    }

    /// The label.
    #[must_use]
    pub const fn label(self) -> Intent {
        match self {
            Self::Valid(intent) => intent,
            Self::Safe(_) => Intent::Relax,
        }
    }

    /// The cause of the safe state; none while valid.
    #[must_use]
    pub const fn cause(self) -> Option<Cause> {
        match self {
            Self::Valid(_) => None,
            Self::Safe(cause) => Some(cause),
        }
    }
}

/// Inputs of [`SafeState`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SafetyEvent {
    /// A sample arrived.
    Sample,
    /// No label is shown, for this cause. The stream goes on.
    NoLabel(Cause),
    /// There is no model, for this cause: no label until the next one is [installed](Self::Installed).
    NoModel(Cause),
    /// The installed model is in use.
    Installed,
    /// The armband was disconnected.
    Disconnected,
    /// Only time passed.
    Tick,
    /// A label of a full window of contiguous samples.
    Label(Intent),
}

/// Decides between valid and safe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SafeState {
    status: Status,
    /// Time of the last sample; none while no stream is running.
    last_sample: Option<Millis>,
    /// The model was refused or is being installed: the state and its cause stay.
    has_no_model: bool,
}

impl SafeState {
    /// The safe state after a reset with this cause.
    #[must_use]
    pub const fn new(start: Cause) -> Self {
        Self {
            status: Status::Safe(start),
            last_sample: None,
            has_no_model: false,
        }
    }

    /// The present state of the outputs.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// Time at which a [`SafetyEvent::Tick`] is due unless a sample arrives before; none while no stream is running.
    #[must_use]
    pub fn deadline(&self) -> Option<Millis> {
        self.last_sample.map(|last| last.plus(SILENCE_MS))
    }

    /// Whether the stream has had no sample for 200 ms at `now`.
    #[must_use]
    pub(crate) fn silent(&self, now: Millis) -> bool {
        self.last_sample
            .is_some_and(|last| now.since(last) >= SILENCE_MS)
    }

    /// Handles an event at `now`. Returns the new status if it became valid, became safe, or is safe for
    /// another cause; a new label while valid is no change of state.
    ///
    /// A silence that this event ends is handled first: a sample does not hide it.
    pub fn handle(&mut self, now: Millis, event: SafetyEvent) -> Option<Status> {
        let before = self.status;
        if self.silent(now) {
            self.end_stream(Cause::Silence);
        }
        match event {
            SafetyEvent::Sample => self.last_sample = Some(now),
            SafetyEvent::NoLabel(cause) => self.enter(cause),
            SafetyEvent::NoModel(cause) => {
                self.status = Status::Safe(cause);
                self.has_no_model = true;
            }
            SafetyEvent::Installed => self.has_no_model = false,
            SafetyEvent::Disconnected => self.end_stream(Cause::Disconnected),
            SafetyEvent::Tick => {}
            // Without a running stream no label ends a silence or a disconnection.
            SafetyEvent::Label(intent) if self.last_sample.is_some() && !self.has_no_model => {
                self.status = Status::Valid(intent);
            }
            SafetyEvent::Label(_) => {}
        }
        let same = match (before, self.status) {
            (Status::Valid(_), Status::Valid(_)) => true,
            (before, after) => before == after,
        };
        (!same).then_some(self.status)
    }

    /// Enters the safe state while the stream continues.
    fn enter(&mut self, cause: Cause) {
        if !self.has_no_model {
            self.status = Status::Safe(cause);
        }
    }

    /// Enters the safe state; the stream has ended.
    fn end_stream(&mut self, cause: Cause) {
        self.last_sample = None;
        self.enter(cause);
    }
}

#[cfg(test)]
mod tests;
