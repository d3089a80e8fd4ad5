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

/// Cause of the last reset.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Start {
    /// Power on, button or debugger.
    Boot,
    /// The watchdog.
    Watchdog,
    /// The program itself, after the stack had grown too deep.
    StackOverflow,
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
    /// Samples were lost and the window was reset.
    Gap,
    /// More samples of the window were lost than may be filled in, and it was reset.
    Losses,
    /// The dead-man timer has expired: the pins are safe already.
    Stalled,
    /// The armband was disconnected.
    Disconnected,
    /// There is a label, and it is locked.
    Locked,
    /// The model file was refused.
    ModelRefused,
    /// Another model is being installed: until then there is no model.
    Installation,
    /// The model is being calibrated: there is no label until that is over.
    Calibration,
    /// The installed model is in use.
    Installed,
    /// Only time passed.
    Tick,
    /// A label of the smoother.
    Label {
        /// The label.
        intent: Intent,
        /// Whether its window was full of contiguous samples.
        window_full: bool,
    },
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
    /// The safe state after a reset.
    #[must_use]
    pub const fn new(start: Start) -> Self {
        let cause = match start {
            Start::Boot => Cause::Boot,
            Start::Watchdog => Cause::Watchdog,
            Start::StackOverflow => Cause::StackOverflow,
        };
        Self {
            status: Status::Safe(cause),
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
            SafetyEvent::Gap => self.enter(Cause::Gap),
            SafetyEvent::Losses => self.enter(Cause::Losses),
            SafetyEvent::Stalled => self.enter(Cause::Stalled),
            SafetyEvent::Locked => self.enter(Cause::Locked),
            SafetyEvent::Calibration => self.enter(Cause::Installation),
            SafetyEvent::Disconnected => self.end_stream(Cause::Disconnected),
            SafetyEvent::ModelRefused => self.end_model(Cause::ModelRefused),
            SafetyEvent::Installation => self.end_model(Cause::Installation),
            SafetyEvent::Installed => self.has_no_model = false,
            SafetyEvent::Tick => {}
            SafetyEvent::Label {
                intent,
                window_full,
            } => self.accept(intent, window_full),
        }
        let same = match (before, self.status) {
            (Status::Valid(_), Status::Valid(_)) => true,
            (before, after) => before == after,
        };
        (!same).then_some(self.status)
    }

    fn accept(&mut self, intent: Intent, window_full: bool) {
        // Without a running stream no label ends a silence or a disconnection.
        let streaming = self.last_sample.is_some();
        if window_full && streaming && !self.has_no_model {
            self.status = Status::Valid(intent);
        }
    }

    /// Enters the safe state while the stream continues.
    fn enter(&mut self, cause: Cause) {
        if !self.has_no_model {
            self.status = Status::Safe(cause);
        }
    }

    /// Enters the safe state, which nothing leaves until a model is installed. The stream may go on.
    const fn end_model(&mut self, cause: Cause) {
        self.status = Status::Safe(cause);
        self.has_no_model = true;
    }

    /// Enters the safe state; the stream has ended.
    fn end_stream(&mut self, cause: Cause) {
        self.last_sample = None;
        self.enter(cause);
    }
}

#[cfg(test)]
mod tests;
