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

mod absence;
mod alignment;
mod calibration;
mod commands;
mod in_use;
mod output;
mod window;

pub use self::absence::{Absence, ModelRefused};
pub use self::alignment::AlignmentPhase;
use self::alignment::Placement;
use self::calibration::{Calibration, Then};
pub use self::commands::Done;
use self::in_use::Network;
pub use self::in_use::{ModelInput, Smoother};
use self::output::Output;
use self::window::{Loss, Next, Window};
use crate::intent::{Intent, MAX_CLASSES};
use crate::model::Encode;
use crate::model::file::Model;
use crate::stream::lock::{Lock, LockTimes};
use crate::stream::normalizer::Normalizer;
use crate::stream::preprocess::Preprocessing;
use crate::stream::ring::Origin;
use crate::stream::safe_state::{Cause, SafetyEvent, Status};
use crate::stream::smoother::{Decision, Settings, SettingsError};
use crate::stream::strength::{Percent, Strength};
use crate::uart_line::calibration::CalibrationState;
use crate::uart_line::{Report, ReportKind};
use crate::units::{Millis, Sample, SampleIndex};

/// Composition of all steps from samples to reports.
pub struct Pipeline<'s, E: Encode> {
    /// Normalizer, for a model that was trained with it. Its state outlasts gaps and disconnections.
    normalizer: Option<Normalizer>,
    /// Strength of the wearer. Its state outlasts gaps and disconnections too.
    strength: Strength,
    placement: Placement,
    window: Window,
    network: Network<'s, E>,
    calibration: Calibration<'s>,
    output: Output,
}

impl<'s, E: Encode> Pipeline<'s, E> {
    /// A pipeline before its first sample, in the safe state after a boot. Resets `state`.
    pub fn new(
        encoder: E,
        state: &'s mut E::State,
        settings: Settings,
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
        let mut pipeline = Self::without_model(state, Cause::Boot);
        pipeline.set_model(encoder, smoother);
        Ok(pipeline)
    }

    /// A pipeline of a model file before its first sample, as the device has it after a boot; `encoder` must be made from the
    /// same model.
    pub fn of_model(
        model: &Model<'_>,
        encoder: E,
        state: &'s mut E::State,
    ) -> Result<Self, SettingsError> {
        let header = &model.header;
        let mut pipeline = Self::new(encoder, state, header.smoother.in_patches())?;
        pipeline.preprocess(header.preprocessing);
        pipeline.set_template(header.template);
        Ok(pipeline)
    }

    /// A pipeline before its first sample, in the safe state after a reset with this cause, that has no model yet. Cannot
    /// fail, so it can be constructed in place.
    pub fn without_model(state: &'s mut E::State, start: Cause) -> Self {
        Self {
            normalizer: None,
            strength: Strength::default(),
            placement: Placement::default(),
            window: Window::new(),
            network: Network::new(state),
            calibration: Calibration::default(),
            output: Output::new(start),
        }
    }

    /// Sets the preprocessing of the model's training; before the first call it is not normalized, with the paper's
    /// median. Forgets the wearer.
    pub fn preprocess(&mut self, preprocessing: Preprocessing) {
        self.normalizer = preprocessing.normalized.then(Normalizer::default);
        self.strength = Strength::default();
        self.window.preprocess(preprocessing);
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
        self.handle(now, SafetyEvent::NoLabel(Cause::Stalled), &mut reports);
        reports
    }

    /// Handles that only time passed. To be called at [`Pipeline::deadline`].
    pub fn tick(&mut self, now: Millis) -> Reports {
        let mut reports = Reports::default();
        if self.output.safe_state.silent(now) {
            self.reset_window();
            self.handle(now, SafetyEvent::Tick, &mut reports);
        }
        reports
    }

    /// Time from which the stream counts as silent unless a sample arrives before; none while no stream is running.
    #[must_use]
    pub fn deadline(&self) -> Option<Millis> {
        self.output.safe_state.deadline()
    }

    /// State of the output pins.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.output.safe_state.status()
    }

    /// Locks the labels until a sign of the wearer, or locks them no longer, from the next label on.
    pub fn set_lock(&mut self, times: Option<LockTimes>) {
        self.output.lock = times.map(Lock::new);
    }

    /// Unlocks the labels, or locks them again, without a sign; nothing if they have no lock.
    pub const fn hold_lock(&mut self, is_locked: bool) {
        self.output.hold_lock(is_locked);
    }

    /// Lock of the labels, if they have one.
    #[must_use]
    pub const fn lock(&self) -> Option<Lock> {
        self.output.lock
    }

    /// A report of the present state, as a program writes it when it starts.
    pub fn state_report(&mut self) -> Report {
        self.report(ReportKind::State, self.window.newest, self.window.newest)
    }

    /// Takes one sample, aligned, received or filled in.
    fn push(&mut self, sample: Sample, origin: Origin) {
        if self.window.push(sample, origin) {
            self.patch_completed();
        }
    }

    /// Has the encoder take a patch if there is one that it has yet to take; returns whether there was.
    fn encode(&mut self, now: Millis, reports: &mut Reports) -> bool {
        if self.decide_arm() {
            return true;
        }
        if !self.window.is_behind() || !self.has_model() {
            return false;
        }
        if let Some(decision) = self.decide() {
            self.label(now, decision, reports);
        }
        true
    }

    /// Has the encoder take a patch, and the smoother decide.
    fn decide(&mut self) -> Option<Decision> {
        let (encoder, smoother, state) = self.network.parts()?;
        // One patch a sample: ten times as fast as they come, and on a device less than the time between two samples.
        let Next {
            patch,
            end,
            behind,
            is_full,
        } = self.window.take();
        let rows = encoder.step(state, patch);
        self.calibration.show_opening(encoder, state, end, behind);
        // The labels that older windows take part in were emitted under the alignment before.
        if !is_full || behind > smoother.look_ahead() {
            return None;
        }
        let decision = smoother.push(end, &rows);
        if !self.calibration.is_busy() {
            return decision;
        }
        if behind == 0 {
            match self.calibration.push(encoder, state, end, decision) {
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
        if self.output.contradicts(decision.instant, intent) {
            return;
        }
        let shown = self.output.show(decision.instant, intent);
        let Some(intent) = shown else {
            self.handle(now, SafetyEvent::NoLabel(Cause::Locked), reports);
            return;
        };
        self.strength.learn(intent, self.rest());
        let event = SafetyEvent::Label(intent);
        let newest = self.window.newest;
        if self.output.safe_state.handle(now, event).is_some() {
            reports.push(self.report(ReportKind::State, decision.instant, newest));
        }
        reports.push(self.report(ReportKind::Label, decision.instant, newest));
    }

    /// Samples are missing before the next one: up to 5 are filled in, more reset the window. So do fewer
    /// with which more than 60 of the window's 600 samples would have been filled in.
    pub fn gap(&mut self, now: Millis, missing: u32) -> Reports {
        let mut reports = self.tick(now);
        match self.window.lose(missing) {
            Loss::Bridged(last) => {
                // A patch a call at most, however far the encoder is behind: the next sample is due.
                let mut encoded = false;
                for _ in 0..missing {
                    self.push(last, Origin::Bridged);
                    encoded = encoded || self.encode(now, &mut reports);
                }
            }
            Loss::Ended(cause) => {
                self.reset_window();
                self.handle(now, SafetyEvent::NoLabel(cause), &mut reports);
            }
            Loss::None => {}
        }
        reports
    }

    /// Resets all steps: the next sample does not follow the previous one.
    fn reset_window(&mut self) {
        if !self.window.reset() {
            return;
        }
        self.output.reset();
        self.end_calibration(CalibrationState::Interrupted);
        self.interrupt_alignment();
        self.network.restart();
    }

    fn handle(&mut self, now: Millis, event: SafetyEvent, reports: &mut Reports) {
        if self.output.safe_state.handle(now, event).is_some() {
            let report = self.state_report();
            reports.push(report);
        }
    }

    /// Level at rest, for the strength; 0 without a normalizer.
    fn rest(&self) -> u32 {
        self.normalizer.as_ref().map_or(0, Normalizer::rest)
    }

    /// Strength of the wearer's contraction in the label of the outputs.
    pub fn strength(&self) -> Percent {
        let label = self.output.safe_state.status().label();
        self.strength.of(label, self.rest())
    }

    fn report(&mut self, kind: ReportKind, instant: SampleIndex, emitted: SampleIndex) -> Report {
        Report {
            kind,
            sequence: self.output.next_sequence(),
            instant,
            emitted,
            status: self.output.safe_state.status(),
            counters: self.window.counters,
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
