//! Course of a session: which cue follows, and what happens after a failed trial.

use recordings::labels::motion::Motion;
use shared::units::SampleIndex;

use super::HoldReason;
use super::input::{Output, RejectReason};
use super::{Phase, Session};
use crate::record::protocol::{Course, MotionStep};

impl Session {
    pub(super) const fn is_guided(&self) -> bool {
        !self.protocol.is_free()
    }

    pub(super) fn begin_round(&mut self, at: SampleIndex) {
        self.round += 1;
        let number = self.round;
        self.outputs.push_back(Output::Round { number, at });
        self.schedule.begin_round();
        self.previous = None;
        self.ready(at);
    }

    pub(super) fn ready(&mut self, at: SampleIndex) {
        let end = at.plus(self.protocol.pause);
        self.phase = Phase::Ready { from: at, end };
        self.set_cue(at, None, 0);
    }

    pub(super) fn set_cue(&mut self, at: SampleIndex, cue: Option<Motion>, trial: u32) {
        self.cue = cue;
        self.trial = trial;
        self.outputs.push_back(Output::Cue { at, cue, trial });
    }

    /// Begins the next trial; after the last one begins the next round, or ends the session.
    pub(super) fn next_trial(&mut self, at: SampleIndex) {
        if !self.is_guided() {
            self.free(at, Motion::RELAX);
            return;
        }
        match self.schedule.begin_block() {
            Some(step) => {
                self.trials += 1;
                self.begin_step(at, step, self.trials);
            }
            None if self.round < self.schedule.rounds() => {
                self.begin_round(at);
            }
            None => self.end(Output::Over),
        }
    }

    fn begin_step(&mut self, at: SampleIndex, step: MotionStep, trial: u32) {
        self.set_cue(at, Some(step.motion), trial);
        let end = Some(at.plus(step.samples));
        self.phase = Phase::Cued { from: at, end };
    }

    pub(super) fn next_step(&mut self, at: SampleIndex) {
        if let Some(step) = self.schedule.next_step() {
            self.begin_step(at, step, self.trial);
        } else {
            self.lost_in_a_row = 0;
            self.previous = Some(self.trial);
            self.next_trial(at);
        }
    }

    /// Sets the cue of a free session: a rest begins a trial, as in a guided one.
    pub(super) fn free(&mut self, at: SampleIndex, motion: Motion) {
        if motion == Motion::RELAX || self.trial == 0 {
            self.previous = (self.trial > 0).then_some(self.trial);
            self.trials += 1;
            self.trial = self.trials;
        }
        let trial = self.trial;
        self.set_cue(at, Some(motion), trial);
        self.phase = Phase::Cued {
            from: at,
            end: None,
        };
    }

    pub(super) fn mark(&mut self, at: SampleIndex, motion: Motion) {
        if let Course::Free { gestures } = &self.protocol.course
            && gestures.contains(&motion)
            && self.cue != Some(motion)
        {
            self.free(at, motion);
        }
    }

    /// Rejects a trial on request: the current one, or the previous one during the rest after it.
    pub(super) fn repeat(&mut self, at: SampleIndex) {
        match self.previous.take() {
            Some(before) if self.cue == Some(Motion::RELAX) => {
                self.bad += 1;
                let (trial, why) = (before, RejectReason::Person);
                self.outputs.push_back(Output::Rejected { trial, why });
                self.schedule.put_back_both();
                self.trial = 0;
            }
            _ => {
                self.fail(RejectReason::Person);
            }
        }
        if self.is_guided() {
            self.next_trial(at);
        } else {
            self.free(at, Motion::RELAX);
        }
    }

    /// Rejects the current trial, which becomes due again.
    pub(super) fn fail(&mut self, why: RejectReason) {
        if self.trial > 0 {
            self.bad += 1;
            let trial = self.trial;
            self.outputs.push_back(Output::Rejected { trial, why });
            self.schedule.put_back();
            self.previous = None;
            self.trial = 0;
        }
    }

    pub(super) fn hold(&mut self, why: HoldReason) {
        if matches!(self.phase, Phase::Cued { .. }) && self.trial > 0 {
            let lost = matches!(why, HoldReason::Losses);
            // Losses have rejected the trial before.
            if !lost {
                self.fail(match why {
                    HoldReason::SourceLost | HoldReason::Silent => RejectReason::Lost,
                    _ => RejectReason::Interrupted,
                });
            }
        }
        self.phase = Phase::Held(why);
        self.cue = None;
        self.trial = 0;
        self.outputs.push_back(Output::Pause);
    }

    /// Ends the session on request and rejects a gesture in progress. A guided one has ended early.
    pub(super) fn finish(&mut self) {
        let cued = matches!(self.phase, Phase::Cued { .. });
        if cued && self.is_guided() && self.cue != Some(Motion::RELAX) {
            self.fail(RejectReason::Interrupted);
        }
        self.end(if self.is_guided() {
            Output::Pause
        } else {
            Output::Over
        });
    }

    fn end(&mut self, output: Output) {
        self.phase = Phase::Over;
        self.cue = None;
        self.trial = 0;
        self.outputs.push_back(output);
    }
}
