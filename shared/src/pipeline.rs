//! The line itself: one sample goes in at the top and, now and then, a label comes out below.
//!
//! ```text
//! Sample -> Preprocessor -> SampleRing -> Encode -> Smoother -> SafeState -> Report
//!           median, |x|     600 samples   a patch:  look-ahead  valid, or    a UART line
//!           lags 1 sample   in patches    6 rows    and hold    relax        each
//! ```
//!
//! No clock, no log, no hardware: callers bring the time and act on what comes back. The same code
//! runs on the device and in `myointent replay`, so both write the same lines.

use crate::intent::{Intent, MAX_CLASSES};
use crate::model::Encode;
use crate::stream::preprocess::Preprocessor;
use crate::stream::ring::SampleRing;
use crate::stream::safe_state::{Event, SafeState, Start, Status};
use crate::stream::smoother::{Settings, SettingsError, Smoother};
use crate::uart_line::{Counters, Kind, Report};
use crate::units::{LOOK_BACK, Millis, Sample, SampleIndex};

/// Most lost samples that are filled in by repeating the last one before them.
pub const MAX_BRIDGED: u32 = 5;

/// What one input made happen, in order: at most a change of state and a label.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reports([Option<Report>; 2]);

impl Reports {
    fn push(&mut self, report: Report) {
        // Two places suffice: silence empties the window, so no label follows it, and a label
        // brings at most one change of state.
        if let Some(free) = self.0.iter_mut().find(|place| place.is_none()) {
            *free = Some(report);
        }
    }
}

impl IntoIterator for Reports {
    type Item = Report;
    type IntoIter = core::iter::Flatten<core::array::IntoIter<Option<Report>, 2>>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter().flatten()
    }
}

/// From samples to reports.
#[derive(Debug)]
pub struct Pipeline<'s, E: Encode> {
    preprocessor: Preprocessor,
    ring: SampleRing,
    encoder: E,
    /// Lent, because it is large and must not move through a device's stack.
    state: &'s mut E::State,
    smoother: Smoother<MAX_CLASSES, LOOK_BACK>,
    guard: SafeState,
    counters: Counters,
    /// Index of the next sample.
    next: SampleIndex,
    /// The last sample, to bridge with; none where nothing may be bridged.
    last: Option<Sample>,
    sequence: u32,
}

impl<'s, E: Encode> Pipeline<'s, E> {
    /// A line before its first sample, in the safe state. What `state` remembers is forgotten.
    ///
    /// # Errors
    /// Refuses settings, or a number of classes, that the smoother refuses.
    pub fn new(
        encoder: E,
        state: &'s mut E::State,
        settings: Settings,
        start: Start,
    ) -> Result<Self, SettingsError> {
        let smoother = Smoother::new(settings, encoder.classes())?;
        Ok(Self::with_smoother(encoder, state, smoother, start))
    }

    /// As [`Pipeline::new`], with a smoother for the encoder's classes: cannot fail, and so can be
    /// made where it is to stay.
    pub fn with_smoother(
        encoder: E,
        state: &'s mut E::State,
        smoother: Smoother<MAX_CLASSES, LOOK_BACK>,
        start: Start,
    ) -> Self {
        encoder.reset(state);
        Self {
            preprocessor: Preprocessor::new(),
            ring: SampleRing::new(),
            smoother,
            state,
            encoder,
            guard: SafeState::new(start),
            counters: Counters::default(),
            next: SampleIndex(0),
            last: None,
            sequence: 0,
        }
    }

    /// A sample came.
    pub fn sample(&mut self, now: Millis, sample: Sample) -> Reports {
        let mut reports = self.tick(now);
        self.tell(now, Event::Sample, &mut reports);
        self.take(now, sample, &mut reports);
        reports
    }

    /// Samples are missing before the next one: up to 5 are filled in, more give up the window.
    pub fn gap(&mut self, now: Millis, missing: u32) -> Reports {
        let mut reports = self.tick(now);
        self.counters.lost = self.counters.lost.saturating_add(missing);
        match self.last {
            Some(last) if missing <= MAX_BRIDGED => {
                self.counters.bridged = self.counters.bridged.saturating_add(missing);
                for _ in 0..missing {
                    self.take(now, last, &mut reports);
                }
            }
            Some(_) => {
                self.next = self.next.plus(missing);
                self.give_up_window();
                self.tell(now, Event::Gap, &mut reports);
            }
            // Nothing has come since the last reset: nothing to give up.
            None => self.next = self.next.plus(missing),
        }
        reports
    }

    /// The armband is gone.
    pub fn disconnected(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        self.give_up_window();
        self.tell(now, Event::Disconnected, &mut reports);
        reports
    }

    /// Nothing came, but time passed: due at [`Pipeline::deadline`].
    pub fn tick(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        if self.guard.silent(now) {
            self.give_up_window();
            self.tell(now, Event::Tick, &mut reports);
        }
        reports
    }

    /// When the stream counts as silent unless a sample comes before.
    #[must_use]
    pub fn deadline(&self) -> Option<Millis> {
        self.guard.deadline()
    }

    /// What the pins must show.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.guard.status()
    }

    /// Losses so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// The state as it is, as a line of its own: what a program writes when it starts.
    pub fn state_report(&mut self) -> Report {
        let newest = SampleIndex(self.next.0.saturating_sub(1));
        self.report(Kind::State, newest, newest)
    }

    /// One sample, received or filled in, all the way down.
    fn take(&mut self, now: Millis, sample: Sample, reports: &mut Reports) {
        let emitted = self.next;
        self.next = emitted.plus(1);
        self.last = Some(sample);
        let Some(clean) = self.preprocessor.push(sample) else {
            return;
        };
        // The median lags one sample.
        let window_end = SampleIndex(emitted.0.wrapping_sub(1));
        let Some(patch) = self.ring.push(clean) else {
            return;
        };
        let rows = self.encoder.step(self.state, patch);
        let window_full = self.ring.is_full();
        if !window_full {
            return;
        }
        let Some(decision) = self.smoother.push(window_end, &rows) else {
            return;
        };
        let Some(intent) = Intent::from_class(decision.class) else {
            return;
        };
        let event = Event::Label {
            intent,
            window_full,
        };
        if self.guard.handle(now, event).is_some() {
            reports.push(self.report(Kind::State, decision.instant, emitted));
        }
        reports.push(self.report(Kind::Label, decision.instant, emitted));
    }

    /// What comes next does not join what came before.
    fn give_up_window(&mut self) {
        if self.last.take().is_none() {
            return;
        }
        self.counters.resets = self.counters.resets.saturating_add(1);
        self.preprocessor = Preprocessor::new();
        self.ring.reset();
        self.encoder.reset(self.state);
        self.smoother.restart();
    }

    fn tell(&mut self, now: Millis, event: Event, reports: &mut Reports) {
        if self.guard.handle(now, event).is_some() {
            let report = self.state_report();
            reports.push(report);
        }
    }

    fn report(&mut self, kind: Kind, instant: SampleIndex, emitted: SampleIndex) -> Report {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        Report {
            kind,
            sequence,
            instant,
            emitted,
            status: self.guard.status(),
            counters: self.counters,
        }
    }
}

#[cfg(test)]
mod tests;
