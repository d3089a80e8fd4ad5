//! The guard behind everything: a label and `valid`, or relax with `valid` low.
//!
//! The device starts safe and becomes safe again on each [`Cause`]. It leaves the safe state only
//! with a label that was made from a full window of contiguous samples; once the model is refused
//! it never does. Time is an argument: it must not run backwards, for an instant earlier than the
//! last sample reads as a long silence and so fails safe.

use crate::intent::Intent;
use crate::units::Millis;

/// Milliseconds without a sample after which the stream counts as silent.
pub const SILENCE_MS: u32 = 200;

/// Why the device is in its safe state.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Cause {
    /// It was switched on.
    Boot,
    /// The watchdog restarted it.
    Watchdog,
    /// The model file was refused. Lasts until the next start.
    ModelRefused,
    /// The armband is gone.
    Disconnected,
    /// No sample came for 200 ms.
    Silence,
    /// More samples were lost than may be bridged.
    Gap,
}

impl Cause {
    /// Every cause.
    pub const ALL: [Self; 6] = [
        Self::Boot,
        Self::Watchdog,
        Self::ModelRefused,
        Self::Disconnected,
        Self::Silence,
        Self::Gap,
    ];

    /// Name on the UART line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Boot => "boot",
            Self::Watchdog => "watchdog",
            Self::ModelRefused => "model-refused",
            Self::Disconnected => "disconnected",
            Self::Silence => "silence",
            Self::Gap => "gap",
        }
    }

    /// The cause of a name as [`Cause::name`] writes it.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|cause| cause.name() == name)
    }
}

/// How the program came to run.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Start {
    /// Power, a button, a debugger.
    Boot,
    /// The watchdog.
    Watchdog,
}

/// What the outputs say.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Status {
    /// `valid` high: this intent, from a full window.
    Valid(Intent),
    /// `valid` low and the label relax.
    Safe(Cause),
}

impl Status {
    /// The level of the `valid` pin.
    #[must_use]
    pub const fn valid(self) -> bool {
        matches!(self, Self::Valid(_))
    }

    /// The label to show.
    #[must_use]
    pub const fn label(self) -> Intent {
        match self {
            Self::Valid(intent) => intent,
            Self::Safe(_) => Intent::Relax,
        }
    }

    /// Why the state is safe; none while valid.
    #[must_use]
    pub const fn cause(self) -> Option<Cause> {
        match self {
            Self::Valid(_) => None,
            Self::Safe(cause) => Some(cause),
        }
    }
}

/// What the guard must hear of.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Event {
    /// A sample came.
    Sample,
    /// Samples are missing and the window was reset.
    Gap,
    /// The armband is gone.
    Disconnected,
    /// The model file was refused.
    ModelRefused,
    /// Nothing but time passed.
    Tick,
    /// The smoother gave a label.
    Label {
        /// The label.
        intent: Intent,
        /// Whether the window behind it was full of contiguous samples.
        window_full: bool,
    },
}

/// The guard's memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SafeState {
    status: Status,
    /// When the last sample came; none while no stream is expected to go on.
    last_sample: Option<Millis>,
}

impl SafeState {
    /// Safe, as after every start.
    #[must_use]
    pub const fn new(start: Start) -> Self {
        let cause = match start {
            Start::Boot => Cause::Boot,
            Start::Watchdog => Cause::Watchdog,
        };
        Self {
            status: Status::Safe(cause),
            last_sample: None,
        }
    }

    /// What the outputs must say now.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// When a [`Event::Tick`] is due unless a sample comes before; none while nothing can fall
    /// silent.
    #[must_use]
    pub fn deadline(&self) -> Option<Millis> {
        self.last_sample.map(|last| last.plus(SILENCE_MS))
    }

    /// Whether the stream has been silent for too long at `now`.
    #[must_use]
    pub fn silent(&self, now: Millis) -> bool {
        self.last_sample
            .is_some_and(|last| now.since(last) >= SILENCE_MS)
    }

    /// Hears of an event at `now`; gives the new status where it became valid, became safe, or is
    /// safe for another cause. A new label while valid is no change of state.
    ///
    /// A silence that only this event ends is noticed first: a sample does not hide it.
    pub fn handle(&mut self, now: Millis, event: Event) -> Option<Status> {
        let before = self.status;
        if self.silent(now) {
            self.stop(Cause::Silence);
        }
        match event {
            Event::Sample => self.last_sample = Some(now),
            Event::Gap => self.fall(Cause::Gap),
            Event::Disconnected => self.stop(Cause::Disconnected),
            Event::ModelRefused => self.stop(Cause::ModelRefused),
            Event::Tick => {}
            Event::Label {
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
        // A label needs a stream that is alive: none may lift a silence or a disconnection.
        let alive = self.last_sample.is_some();
        if window_full && alive && self.status != Status::Safe(Cause::ModelRefused) {
            self.status = Status::Valid(intent);
        }
    }

    /// Safe, with the stream going on.
    fn fall(&mut self, cause: Cause) {
        if self.status != Status::Safe(Cause::ModelRefused) {
            self.status = Status::Safe(cause);
        }
    }

    /// Safe, with no stream to wait for.
    fn stop(&mut self, cause: Cause) {
        self.last_sample = None;
        self.fall(cause);
    }
}

#[cfg(test)]
mod tests;
