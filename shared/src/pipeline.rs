//! The pipeline from a sample to a label, composed of the modules of [`stream`](crate::stream) and
//! [`model`](crate::model).
//!
//! ```text
//! Sample -> Normalizer -> Alignment -> Preprocessor -> SampleRing -> Encode -> Smoother -> Lock -> SafeState -> Report
//!           rest,         which        median, |x|     600 samples   a patch:  look-ahead  if     valid, or    a UART line
//!           strength      electrode    lags 1 sample   in patches    6 rows    and hold    wanted relax        each
//!    |                                                                                                       |
//!    +---> Strength: level above rest, as a share of the label's range --------------------------------------+
//! ```
//!
//! A change of the alignment rearranges the samples of the ring, and the encoder takes them again, a patch with each
//! sample: the label stays for at most 0.35 s and then is what it would be had the armband always sat so. Where the model
//! decides on the arm, the encoder takes them twice more before, and the label stays for at most 0.9 s.
//!
//! No clock, no log, no hardware: the caller passes the time and handles the reports. Device and
//! `myointent replay` run the same code, so both write the same UART lines.

mod alignment;
mod calibration;
mod in_use;
mod losses;

pub use self::alignment::AlignmentPhase;
use self::alignment::Placement;
use self::calibration::{Calibration, Then};
use self::in_use::InUse;
pub use self::in_use::{Input, Smoother};
use crate::intent::{Intent, MAX_CLASSES};
use crate::model::Encode;
use crate::model::file::Model;
use crate::stream::lock::{Lock, LockTimes};
use crate::stream::normalizer::Normalizer;
use crate::stream::preprocess::{Preprocessing, Preprocessor};
use crate::stream::ring::{Origin, SampleRing};
use crate::stream::safe_state::{SafeState, SafetyEvent, Start, Status};
use crate::stream::smoother::{Decision, Settings, SettingsError};
use crate::stream::strength::{Percent, Strength};
use crate::uart_line::calibration::CalibrationState;
use crate::uart_line::{Counters, Report, ReportKind};
use crate::units::{Millis, PATCH, Sample, SampleIndex, WINDOW_PATCHES};

/// Composition of all steps from samples to reports.
#[derive(Debug)]
pub struct Pipeline<'s, E: Encode> {
    /// Preprocessing that the model requires.
    preprocessing: Preprocessing,
    /// Normalizer, for a model that was trained with it. Its state outlasts gaps and disconnections.
    normalizer: Option<Normalizer>,
    /// Strength of the wearer. Its state outlasts gaps and disconnections too.
    strength: Strength,
    placement: Placement,
    preprocessor: Preprocessor,
    ring: SampleRing,
    /// Complete patches in the ring that the encoder has yet to take, the newest ones.
    behind: usize,
    /// Model in use; `None` if it was refused, or while another model is being installed.
    model: Option<InUse<E>>,
    /// Borrowed: it is too large to be moved over a device's stack.
    state: &'s mut E::State,
    safe_state: SafeState,
    counters: Counters,
    /// The newest sample of the ring's newest complete patch.
    newest_end: SampleIndex,
    /// Position of the next sample.
    next: SampleIndex,
    /// Position of the newest sample, lost ones included; 0 before the first.
    newest: SampleIndex,
    /// The last sample, aligned, which fills gaps; none where no gap may be filled.
    last: Option<Sample>,
    /// The newest label; none since a reset of the window.
    label: Option<(SampleIndex, Intent)>,
    /// Lock of the labels; none if they are not locked.
    lock: Option<Lock>,
    calibration: Calibration<'s>,
    sequence: u32,
}

impl<'s, E: Encode> Pipeline<'s, E> {
    /// A pipeline before its first sample, in the safe state. Resets `state`.
    ///
    /// # Errors
    /// If the smoother refuses the settings or the encoder's number of classes.
    pub fn new(
        encoder: E,
        state: &'s mut E::State,
        settings: Settings,
        start: Start,
    ) -> Result<Self, SettingsError> {
        let classes = encoder.classes();
        // The last column of the logits is no class.
        if classes > MAX_CLASSES {
            return Err(SettingsError::Classes {
                most: MAX_CLASSES,
                found: classes,
            });
        }
        let smoother = Smoother::new(settings, classes)?;
        let mut pipeline = Self::without_model(state, start);
        pipeline.set_model(encoder, smoother);
        Ok(pipeline)
    }

    /// A pipeline of a model file before its first sample, as the device has it after a boot; `encoder` must be made from the
    /// same model.
    ///
    /// # Errors
    /// If the smoother refuses the settings of the model.
    pub fn of_model(
        model: &Model<'_>,
        encoder: E,
        state: &'s mut E::State,
    ) -> Result<Self, SettingsError> {
        let header = &model.header;
        let mut pipeline = Self::new(encoder, state, header.smoother.in_patches(), Start::Boot)?;
        pipeline.preprocess(header.preprocessing);
        pipeline.set_template(header.template);
        Ok(pipeline)
    }

    /// A pipeline before its first sample, in the safe state, that has no model yet. Cannot fail, so it can be constructed
    /// in place.
    pub fn without_model(state: &'s mut E::State, start: Start) -> Self {
        Self {
            preprocessing: Preprocessing::default(),
            normalizer: None,
            strength: Strength::new(),
            placement: Placement::default(),
            preprocessor: Preprocessor::default(),
            ring: SampleRing::new(),
            behind: 0,
            model: None,
            state,
            safe_state: SafeState::new(start),
            counters: Counters::default(),
            newest_end: SampleIndex(0),
            next: SampleIndex(0),
            newest: SampleIndex(0),
            last: None,
            label: None,
            lock: None,
            calibration: Calibration::default(),
            sequence: 0,
        }
    }

    /// Sets the preprocessing of the model's training; before the first call it is not normalized, with the paper's
    /// median. Forgets the wearer.
    pub fn preprocess(&mut self, preprocessing: Preprocessing) {
        self.preprocessing = preprocessing;
        self.normalizer = preprocessing.normalized.then(Normalizer::new);
        self.strength = Strength::new();
        self.preprocessor = Preprocessor::new(preprocessing.median);
    }

    /// Takes the next sample.
    pub fn sample(&mut self, now: Millis, sample: Sample) -> Reports {
        let mut reports = self.tick(now);
        self.handle(now, SafetyEvent::Sample, &mut reports);
        self.watch(sample);
        self.calibration.sample(sample);
        self.strength.push(sample);
        let sample = match &mut self.normalizer {
            Some(normalizer) => normalizer.push(sample),
            None => sample,
        };
        let sample = self.placement.current.apply(sample);
        self.push(sample, Origin::Received);
        self.encode(now, &mut reports);
        reports
    }

    /// The armband was disconnected; its alignment is dropped.
    pub fn disconnected(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        // First: a decision between the arms is not interrupted but dropped.
        self.drop_alignment();
        self.reset_window();
        self.handle(now, SafetyEvent::Disconnected, &mut reports);
        reports
    }

    /// The dead-man timer has expired, and the pins are safe: whatever was computed in time was not shown in time.
    pub fn stalled(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        self.reset_window();
        self.handle(now, SafetyEvent::Stalled, &mut reports);
        reports
    }

    /// Handles that only time passed. To be called at [`Pipeline::deadline`].
    pub fn tick(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        if self.safe_state.silent(now) {
            self.reset_window();
            self.handle(now, SafetyEvent::Tick, &mut reports);
        }
        reports
    }

    /// Time from which the stream counts as silent unless a sample arrives before; none while no stream is running.
    #[must_use]
    pub fn deadline(&self) -> Option<Millis> {
        self.safe_state.deadline()
    }

    /// State of the output pins.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.safe_state.status()
    }

    /// Locks the labels until a sign of the wearer, or locks them no longer, from the next label on.
    pub fn set_lock(&mut self, times: Option<LockTimes>) {
        self.lock = times.map(Lock::new);
    }

    /// Unlocks the labels, or locks them again, without a sign; nothing if they have no lock.
    pub const fn hold_lock(&mut self, is_locked: bool) {
        match &mut self.lock {
            Some(lock) if is_locked => lock.lock(),
            Some(lock) => lock.unlock(),
            None => {}
        }
    }

    /// Lock of the labels, if they have one.
    #[must_use]
    pub const fn lock(&self) -> Option<Lock> {
        self.lock
    }

    /// A report of the present state, as a program writes it when it starts.
    pub fn state_report(&mut self) -> Report {
        self.report(ReportKind::State, self.newest, self.newest)
    }

    /// Takes one sample, aligned, received or filled in.
    fn push(&mut self, sample: Sample, origin: Origin) {
        self.newest = self.next;
        self.next = self.newest.plus(1);
        self.last = Some(sample);
        let Some(clean) = self.preprocessor.push(sample) else {
            return;
        };
        if self.ring.push(clean, origin).is_some() {
            // The preprocessor lags one sample.
            self.newest_end = SampleIndex(self.newest.0.wrapping_sub(1));
            self.behind += 1;
            self.patch_completed();
        }
    }

    /// Has the encoder take a patch if there is one that it has yet to take; returns whether there was.
    fn encode(&mut self, now: Millis, reports: &mut Reports) -> bool {
        if self.decide_arm() {
            return true;
        }
        if self.behind == 0 || self.model.is_none() {
            return false;
        }
        if let Some(decision) = self.decide() {
            self.label(now, decision, reports);
        }
        true
    }

    /// Has the encoder take a patch, and the smoother decide.
    fn decide(&mut self) -> Option<Decision> {
        let InUse { encoder, smoother } = self.model.as_mut()?;
        // One patch a sample: ten times as fast as they come, and on a device less than the time between two samples.
        let behind = self.behind.min(self.ring.complete()).saturating_sub(1);
        self.behind = behind;
        let patch = self.ring.before_newest(behind);
        let rows = encoder.step(self.state, patch);
        let after = (behind * PATCH) as u32;
        let window_end = SampleIndex(self.newest_end.0.wrapping_sub(after));
        self.calibration
            .again(encoder, self.state, window_end, behind);
        let window_full = self.ring.contiguous() as usize / PATCH >= WINDOW_PATCHES + behind;
        // The labels that older windows take part in were emitted under the alignment before.
        if !window_full || behind > smoother.look_ahead() {
            return None;
        }
        let decision = smoother.push(window_end, &rows);
        if !self.calibration.is_busy() {
            return decision;
        }
        if behind == 0 {
            let state = &mut *self.state;
            match self.calibration.push(encoder, state, window_end, decision) {
                Then::Nothing => {}
                Then::Encode => self.encode_anew(),
                Then::Align(profile) => self.align_by(profile),
            }
            self.undo_alignment();
        }
        None
    }

    /// Reports a label unless it contradicts one before.
    fn label(&mut self, now: Millis, decision: Decision, reports: &mut Reports) {
        let Some(intent) = Intent::from_class(decision.class) else {
            return;
        };
        if self.contradicts(decision.instant, intent) {
            return;
        }
        self.label = Some((decision.instant, intent));
        let shown = match &mut self.lock {
            Some(lock) => lock.push(decision.instant, intent),
            None => Some(intent),
        };
        let Some(intent) = shown else {
            self.handle(now, SafetyEvent::Locked, reports);
            return;
        };
        self.strength.learn(intent, self.rest());
        // No other window is decided.
        let event = SafetyEvent::Label {
            intent,
            window_full: true,
        };
        if self.safe_state.handle(now, event).is_some() {
            reports.push(self.report(ReportKind::State, decision.instant, self.newest));
        }
        reports.push(self.report(ReportKind::Label, decision.instant, self.newest));
    }

    /// Whether an instant has another label, or is before one that has a label. So it may be where samples were taken
    /// again after an early label: it stands, and what the samples say now counts from the next instant on.
    fn contradicts(&self, instant: SampleIndex, intent: Intent) -> bool {
        self.label
            .is_some_and(|(labelled, before)| match labelled.since(instant) {
                0 => intent != before,
                later => later < 1 << 31,
            })
    }

    /// Resets all steps: the next sample does not follow the previous one.
    fn reset_window(&mut self) {
        if self.last.take().is_none() {
            return;
        }
        self.counters.resets = self.counters.resets.saturating_add(1);
        self.preprocessor = Preprocessor::new(self.preprocessing.median);
        self.ring.reset();
        self.behind = 0;
        self.label = None;
        self.hold_lock(true);
        self.end_calibration(CalibrationState::Interrupted);
        self.interrupt_alignment();
        self.restart_model();
    }

    fn handle(&mut self, now: Millis, event: SafetyEvent, reports: &mut Reports) {
        if self.safe_state.handle(now, event).is_some() {
            let report = self.state_report();
            reports.push(report);
        }
    }

    /// Number of the next line.
    const fn next_sequence(&mut self) -> u32 {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        sequence
    }

    /// Level at rest, for the strength; 0 without a normalizer.
    fn rest(&self) -> u32 {
        self.normalizer.as_ref().map_or(0, Normalizer::rest)
    }

    /// Strength of the wearer's contraction in the label of the outputs.
    pub fn strength(&self) -> Percent {
        let label = self.safe_state.status().label();
        self.strength.of(label, self.rest())
    }

    fn report(&mut self, kind: ReportKind, instant: SampleIndex, emitted: SampleIndex) -> Report {
        let status = self.safe_state.status();
        Report {
            kind,
            sequence: self.next_sequence(),
            instant,
            emitted,
            status,
            counters: self.counters,
            strength: Some(self.strength()),
        }
    }
}

/// Reports of one input, in order: at most a change of state and a label.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reports([Option<Report>; 2]);

impl Reports {
    fn push(&mut self, report: Report) {
        // Two suffice: silence empties the window, so no label follows it; the encoder takes one patch at most, also in a
        // gap; and a label causes at most one change of state.
        if let Some(free) = self.0.iter_mut().find(|slot| slot.is_none()) {
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

#[cfg(test)]
mod tests;
