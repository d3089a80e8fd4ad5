//! Recording session without I/O: samples and actions of the person go in, cues come out.
//!
//! ```text
//! session.handle(now, Input::Samples { .. });          // now: Millis, always an argument
//! while let Some(output) = session.poll() { .. }        // cues, bad trials, rounds: what is written down
//! session.view()                                        // what a page shows
//! ```
//!
//! Time is the stream's: a cue begins and ends at a sample, so that the page and the journal agree to the sample, and the
//! session is held while the stream stands still. The clock only tells that it does.

mod continuity;
mod course;
mod input;
mod schedule;
mod view;

use std::collections::VecDeque;

use recordings::labels::motion::Motion;
use shared::units::{Millis, SampleIndex};

pub use self::continuity::{Continuity, IndexGapDetector, has_reached};
pub use self::input::{Action, Input, Output, RejectReason};
use self::schedule::RoundSchedule;
pub use self::view::{HoldReason, UpcomingStep, View};
use super::protocol::Protocol;

/// Time without samples after which a session is held: longer than delays of a busy PC.
const SILENCE_MS: u32 = 2_000;
/// Trials lost in a row, each repeated automatically, after which the session is held.
const MOST_LOST: u32 = 3;

/// Phase of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    Waiting,
    /// Countdown until a sample.
    Ready {
        from: SampleIndex,
        end: SampleIndex,
    },
    /// Cue until a sample; without an end in a free session.
    Cued {
        from: SampleIndex,
        end: Option<SampleIndex>,
    },
    Held(HoldReason),
    Over,
}

/// Recording session.
#[derive(Debug)]
pub struct Session {
    protocol: Protocol,
    phase: Phase,
    schedule: RoundSchedule,
    /// Current cue and number of the attempt.
    cue: Option<Motion>,
    trial: u32,
    /// Number of the previous attempt.
    previous: Option<u32>,
    trials: u32,
    bad: u32,
    lost_in_a_row: u32,
    stream: IndexGapDetector,
    /// Time of the last samples.
    last_samples: Option<Millis>,
    round: u32,
    outputs: VecDeque<Output>,
}

impl Session {
    /// Creates a session that waits for its beginning.
    pub fn new(protocol: Protocol) -> Self {
        Self {
            schedule: RoundSchedule::new(&protocol.course),
            protocol,
            phase: Phase::Waiting,
            cue: None,
            trial: 0,
            previous: None,
            trials: 0,
            bad: 0,
            lost_in_a_row: 0,
            stream: IndexGapDetector::default(),
            last_samples: None,
            round: 0,
            outputs: VecDeque::new(),
        }
    }

    /// Takes an input. Drain [`poll`](Self::poll) before the next call.
    pub fn handle(&mut self, now: Millis, input: Input) {
        match input {
            Input::Samples { first, count } => self.samples(now, first, count),
            Input::Tick => {
                let silent = |last: Millis| now.elapsed_since(last) >= SILENCE_MS;
                if self.is_running() && self.last_samples.is_some_and(silent) {
                    self.hold(HoldReason::Silent);
                }
            }
            Input::Hold(why) => {
                if why == HoldReason::SourceLost {
                    self.stream = IndexGapDetector::default();
                }
                // A session that does not run needs no hold.
                if self.is_running() {
                    self.hold(why);
                }
            }
            Input::Action(action) => self.action(action),
        }
    }

    /// Returns the next output.
    pub fn poll(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    /// Whether samples are kept: from the countdown of a round on, but not while the session waits.
    pub const fn is_running(&self) -> bool {
        matches!(self.phase, Phase::Ready { .. } | Phase::Cued { .. })
    }

    /// Whether samples have come, so that a session can begin.
    pub const fn has_stream(&self) -> bool {
        self.stream.next().is_some()
    }

    /// Whether the session has ended.
    pub const fn is_over(&self) -> bool {
        matches!(self.phase, Phase::Over)
    }

    fn samples(&mut self, now: Millis, first: SampleIndex, count: u32) {
        self.last_samples = Some(now);
        match self.stream.take(first, count) {
            Continuity::Next | Continuity::Bridged(_) => {}
            Continuity::Restart => {
                if self.is_running() {
                    self.hold(HoldReason::SourceLost);
                }
            }
            Continuity::Lost(_) => self.lost(first),
        }
        let end = first.plus(count);
        loop {
            match self.phase {
                Phase::Ready { end: at, .. } if has_reached(end, at) => self.next_trial(at),
                Phase::Cued { end: Some(at), .. } if has_reached(end, at) => self.next_step(at),
                _ => break,
            }
        }
    }

    /// Handles a gap before a sample.
    fn lost(&mut self, first: SampleIndex) {
        match self.phase {
            Phase::Cued { .. } => {
                self.fail(RejectReason::Lost);
                self.lost_in_a_row += 1;
                if self.lost_in_a_row >= MOST_LOST {
                    self.hold(HoldReason::Losses);
                } else if self.is_guided() {
                    self.next_trial(first);
                } else {
                    self.free(first, Motion::RELAX);
                }
            }
            Phase::Ready { .. } => self.ready(first),
            _ => {}
        }
    }

    fn action(&mut self, action: Action) {
        let Some(at) = self.stream.next() else {
            // A session without a stream can only be ended.
            if action == Action::Finish && !self.is_over() {
                self.finish();
            }
            return;
        };
        match (action, self.phase) {
            (_, Phase::Over) => {}
            (Action::Begin, Phase::Waiting) => {
                self.begin_round(at);
            }
            (Action::Begin, Phase::Held(_)) => {
                self.lost_in_a_row = 0;
                self.ready(at);
            }
            (Action::Repeat, Phase::Cued { .. }) => self.repeat(at),
            (Action::Hold, Phase::Ready { .. } | Phase::Cued { .. }) => {
                self.hold(HoldReason::Person)
            }
            (Action::Finish, _) => self.finish(),
            (Action::Mark(motion), Phase::Cued { .. }) => self.mark(at, motion),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
