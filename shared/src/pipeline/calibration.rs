//! Calibration as a part of the pipeline: the wearer's last layer, learnt while the stream goes on.

use super::{Pipeline, Reports, Smoother};
use crate::calibration::{CalibrationProgress, CalibrationSession, Memory, REACTION, Shown};
use crate::intent::Intent;
use crate::model::Encode;
use crate::stream::alignment::{Alignment, Arm, Profile};
use crate::stream::safe_state::{Cause, SafetyEvent};
use crate::stream::smoother::Decision;
use crate::uart_line::calibration::{CalibrationReport, CalibrationState};
use crate::units::{Millis, Sample, SampleIndex, WINDOW_PATCHES};

/// Calibration, as far as a pipeline knows it.
#[derive(Debug, Default)]
pub(super) struct Calibration<'s> {
    /// Memory; none on a device without room for it, and while the result is being kept.
    memory: Option<&'s mut Memory>,
    course: Option<Course>,
    /// A head was learnt, and is not in use yet.
    has_learnt: bool,
    pub(super) news: Option<CalibrationReport>,
    /// Alignment from before a calibration that ended without a head: to be put in force again.
    before: Option<Alignment>,
}

/// Task that a patch leaves to the pipeline.
pub(super) enum Then {
    /// Nothing.
    Nothing,
    /// To encode all samples again: the encoder's state was used for other things.
    Encode,
    /// To align the armband by an opening with this profile as received.
    Align(Profile),
}

/// A calibration in progress.
#[derive(Debug)]
struct Course {
    session: CalibrationSession,
    /// Smoother of the learnt head's logits.
    smoother: Smoother,
    /// Newest labels of the head in use and of the learnt one.
    labels: [Option<Intent>; 2],
    arm: Arm,
    /// End of the opening of round one, once it is over.
    opened: SampleIndex,
    /// The armband was aligned by that opening.
    is_realigned: bool,
    /// Alignment in force when the calibration began.
    before: Alignment,
}

impl Calibration<'_> {
    /// Whether no label is shown: a head is being learnt, or waits to be used.
    pub(super) const fn is_busy(&self) -> bool {
        self.course.is_some() || self.has_learnt
    }

    pub(super) fn sample(&mut self, sample: Sample) {
        if let Some(course) = &mut self.course {
            course.session.sample(sample);
        }
    }

    /// Ends a calibration in progress: nothing changes.
    fn end(&mut self, state: CalibrationState) {
        if let Some(course) = self.course.take() {
            self.before = Some(course.before);
            self.news = Some(CalibrationReport::of(state, Some(course.session.cue())));
        }
    }

    /// The electrodes were rearranged. The patches shown before are forgotten; the opening is taken again, as far as
    /// the window holds it.
    pub(super) fn realigned(&mut self) {
        if let (Some(course), Some(memory)) = (&mut self.course, &mut self.memory) {
            memory.sums.clear();
            course.is_realigned = true;
        }
    }

    /// Takes the encoder's step at a patch of the opening again, after the electrodes were rearranged; `behind` patches follow it.
    pub(super) fn show_opening<E: Encode>(
        &mut self,
        encoder: &E,
        state: &E::State,
        window_end: SampleIndex,
        behind: usize,
    ) {
        let (Some(course), Some(memory)) = (&self.course, &mut self.memory) else {
            return;
        };
        let is_opening = course.is_realigned && course.opened.since(window_end) < 1 << 31;
        // The first `REACTION` patches do not count, as in a cue: the encoder looks back.
        if is_opening && behind + (REACTION as usize) < WINDOW_PATCHES {
            let open = Shown::Intent(Intent::Open);
            memory.sums.add(encoder.hidden(state), open);
        }
    }

    /// Knowledge of the arm, for an alignment.
    pub(super) fn arm(&self) -> Arm {
        self.course.as_ref().map_or(Arm::Unknown, |own| own.arm)
    }

    /// Takes a step of the encoder and the label that it gave.
    pub(super) fn push<E: Encode>(
        &mut self,
        encoder: &E,
        state: &mut E::State,
        window_end: SampleIndex,
        decision: Option<Decision>,
    ) -> Then {
        let (Some(course), Some(memory)) = (&mut self.course, &mut self.memory) else {
            return Then::Nothing;
        };
        let Course {
            session,
            smoother,
            labels,
            opened,
            ..
        } = course;
        let Memory { sums, head, .. } = &mut **memory;
        if session.is_judging() {
            let rows = encoder.logits_by(head, state);
            let learnt = smoother.push(window_end, &rows);
            for (label, newest) in labels.iter_mut().zip([decision, learnt]) {
                *label = newest.map_or(*label, |newest| Intent::from_class(newest.class));
            }
        }
        if session.counts() {
            sums.add(encoder.hidden(state), session.cue());
        }
        match session.push(*labels) {
            CalibrationProgress::Same => return Then::Nothing,
            CalibrationProgress::Next => {
                self.say_cue();
                return Then::Nothing;
            }
            CalibrationProgress::Opened(profile) => {
                *opened = window_end;
                self.say_cue();
                return Then::Align(profile);
            }
            CalibrationProgress::Weak => {
                self.end(CalibrationState::Weak);
                return Then::Nothing;
            }
            CalibrationProgress::Taught => {
                if encoder.solve(sums, state, head).is_ok() {
                    self.say_cue();
                } else {
                    self.end(CalibrationState::Unusable);
                }
            }
            CalibrationProgress::Judged => {
                let judgement = *session.judgement();
                let state = if !judgement.accepts() {
                    CalibrationState::Worse
                } else if encoder.solve(sums, state, head).is_ok() {
                    self.has_learnt = true;
                    CalibrationState::Keeping
                } else {
                    CalibrationState::Unusable
                };
                let ended = self.course.take().filter(|_| !self.has_learnt);
                self.before = ended.map(|course| course.before);
                self.news = Some(CalibrationReport::judged(state, judgement.recalls()));
            }
        }
        Then::Encode
    }

    fn say_cue(&mut self) {
        if let Some(Course { session, .. }) = &self.course {
            let state = if session.is_judging() {
                CalibrationState::Judging
            } else {
                CalibrationState::Teaching
            };
            self.news = Some(CalibrationReport::of(state, Some(session.cue())));
        }
    }
}

impl<'s, E: Encode> Pipeline<'s, E> {
    /// Gives memory for calibrations, or gives it back after [`Pipeline::take_learnt`]: then the learnt head is in use, or was
    /// given up.
    pub fn lend(&mut self, memory: &'s mut Memory) {
        self.calibration.memory = Some(memory);
        self.calibration.has_learnt = false;
    }

    /// Begins a calibration, anew if one is in progress; with other movement in round one if wanted. No label is valid until it
    /// is over. An alignment in progress is cancelled: the opening of round one aligns the armband, with what is known of
    /// the arm, whatever the alignment in force says. `None` without memory, without a model, or if the model has no output
    /// for other movement and it is wanted.
    pub fn begin_calibration(&mut self, now: Millis, others: bool, arm: Arm) -> Option<Reports> {
        let (encoder, smoother) = self.network.model()?;
        let memory = self.calibration.memory.as_mut()?;
        if others && !smoother.knows_other() {
            return None;
        }
        memory.sums.clear();
        let mut smoother = smoother.clone();
        smoother.restart();
        let session = CalibrationSession::new(encoder.classes(), others);
        self.cancel_alignment();
        self.calibration.course = Some(Course {
            session,
            smoother,
            labels: [None; 2],
            arm,
            opened: SampleIndex(0),
            is_realigned: false,
            before: self.placement.current,
        });
        self.calibration.say_cue();
        let mut reports = Reports::default();
        self.handle(now, SafetyEvent::NoLabel(Cause::Installation), &mut reports);
        Some(reports)
    }

    /// Ends a calibration in progress; the head stays. Returns whether there was one.
    pub fn cancel_calibration(&mut self) -> bool {
        let is_running = self.calibration.course.is_some();
        if is_running {
            self.end_alignment();
        }
        self.end_calibration(CalibrationState::Cancelled);
        is_running
    }

    /// Ends a calibration in progress: head and alignment are those from before it.
    pub(super) fn end_calibration(&mut self, state: CalibrationState) {
        self.calibration.end(state);
        self.undo_alignment();
    }

    /// Puts the alignment from before a calibration in force again that ended without a head.
    pub(super) fn undo_alignment(&mut self) {
        if let Some(before) = self.calibration.before.take()
            && before != self.placement.current
        {
            self.set_alignment(before);
        }
    }

    /// The newest report about the calibration since the last call; to be called after every other method.
    pub const fn take_calibration_report(&mut self) -> Option<CalibrationReport> {
        self.calibration.news.take()
    }

    /// Memory with a head that was learnt and is to be kept; no label is valid until it is [given back](Pipeline::lend).
    pub const fn take_learnt(&mut self) -> Option<&'s mut Memory> {
        if !self.calibration.has_learnt {
            return None;
        }
        let mut memory = self.calibration.memory.take();
        if let Some(memory) = &mut memory {
            memory.alignment = self.placement.current;
        }
        memory
    }
}
