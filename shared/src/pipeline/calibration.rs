//! Calibration as a part of the pipeline: the wearer's last layer, learnt while the stream goes on.

use super::{Pipeline, Reports, Smoother};
use crate::calibration::{Memory, Progress, Session};
use crate::intent::Intent;
use crate::model::Encode;
use crate::stream::safe_state::Event;
use crate::stream::smoother::Decision;
use crate::uart_line::calibration::{CalibrationReport, CalibrationState};
use crate::units::{Millis, Sample, SampleIndex};

/// Calibration, as far as a pipeline knows it.
#[derive(Debug, Default)]
pub(super) struct Calibration<'s> {
    /// Memory; none on a device without room for it, and while the result is being kept.
    memory: Option<&'s mut Memory>,
    course: Option<Course>,
    /// A head was learnt, and is not in use yet.
    has_learnt: bool,
    news: Option<CalibrationReport>,
}

/// A calibration in progress.
#[derive(Debug)]
struct Course {
    session: Session,
    /// Smoother of the learnt head's logits.
    smoother: Smoother,
    /// Newest labels of the head in use and of the learnt one.
    labels: [Option<Intent>; 2],
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
    pub(super) fn end(&mut self, state: CalibrationState) {
        if let Some(course) = self.course.take() {
            self.news = Some(CalibrationReport::of(state, Some(course.session.cue())));
        }
    }

    /// Takes a step of the encoder and the label that it gave. Returns whether the encoder's state was used for other things.
    pub(super) fn push<E: Encode>(
        &mut self,
        encoder: &E,
        state: &mut E::State,
        window_end: SampleIndex,
        decision: Option<Decision>,
    ) -> bool {
        let (Some(course), Some(memory)) = (&mut self.course, &mut self.memory) else {
            return false;
        };
        let Course {
            session,
            smoother,
            labels,
        } = course;
        let Memory { sums, head } = &mut **memory;
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
            Progress::Same => return false,
            Progress::Next => {
                self.say_cue();
                return false;
            }
            Progress::Weak => {
                self.end(CalibrationState::Weak);
                return false;
            }
            Progress::Taught => {
                if encoder.solve(sums, state, head).is_ok() {
                    self.say_cue();
                } else {
                    self.end(CalibrationState::Unusable);
                }
            }
            Progress::Judged => {
                let judgement = *session.judgement();
                let state = if !judgement.accepts() {
                    CalibrationState::Worse
                } else if encoder.solve(sums, state, head).is_ok() {
                    self.has_learnt = true;
                    CalibrationState::Keeping
                } else {
                    CalibrationState::Unusable
                };
                self.course = None;
                self.news = Some(CalibrationReport::judged(state, judgement.recalls()));
            }
        }
        true
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
    /// is over. An alignment in progress is cancelled. `None` without memory, without a model, or if the model has no output
    /// for other movement and it is wanted.
    pub fn begin_calibration(&mut self, now: Millis, others: bool) -> Option<Reports> {
        let model = self.model.as_ref()?;
        let memory = self.calibration.memory.as_mut()?;
        if others && !model.smoother.knows_other() {
            return None;
        }
        memory.sums.clear();
        let mut smoother = model.smoother.clone();
        smoother.restart();
        let session = Session::new(model.encoder.classes(), others);
        self.cancel_alignment();
        self.calibration.course = Some(Course {
            session,
            smoother,
            labels: [None; 2],
        });
        self.calibration.say_cue();
        let mut reports = Reports::default();
        self.handle(now, Event::Calibration, &mut reports);
        Some(reports)
    }

    /// Ends a calibration in progress; nothing changes. Returns whether there was one.
    pub fn cancel_calibration(&mut self) -> bool {
        let is_running = self.calibration.course.is_some();
        self.calibration.end(CalibrationState::Cancelled);
        is_running
    }

    /// The newest report about the calibration since the last call; to be called after every other method.
    pub const fn take_calibration_report(&mut self) -> Option<CalibrationReport> {
        self.calibration.news.take()
    }

    /// Memory with a head that was learnt and is to be kept; no label is valid until it is [given back](Pipeline::lend).
    pub const fn take_learnt(&mut self) -> Option<&'s mut Memory> {
        if self.calibration.has_learnt {
            self.calibration.memory.take()
        } else {
            None
        }
    }
}
