//! View of a session for a page, in samples of the stream.

use recordings::labels::motion::Motion;
use serde::Serialize;

use super::{Phase, Session};

/// Reason why a session is held.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HoldReason {
    /// The person asked for it.
    Person,
    /// The leader has left the page.
    LeaderLeft,
    /// The source was lost or has restarted.
    SourceLost,
    /// No sample came for two seconds.
    Silent,
    /// Several trials in a row have lost samples.
    Losses,
    /// The journal cannot be written.
    Disk,
    /// The journal was deleted, moved or replaced.
    Gone,
}

/// Coming step.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct UpcomingStep {
    /// Motion to perform.
    pub cue: &'static str,
    /// Duration in samples.
    pub samples: u32,
}

/// State of a session for a page.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct View {
    /// Phase: `waiting`, `ready`, `cued`, `held` or `over`.
    pub phase: &'static str,
    /// Name of the protocol.
    pub protocol: String,
    /// Whether the session is free.
    pub free: bool,
    /// Motions of the protocol.
    pub classes: Vec<&'static str>,
    /// Reason for the hold, if it is held.
    pub why: Option<HoldReason>,
    /// Motion of the current cue.
    pub cue: Option<&'static str>,
    /// First sample of the countdown or the cue.
    pub from: Option<u32>,
    /// Sample after the last one of the countdown or the cue; none for a cue of a free session.
    pub end: Option<u32>,
    /// Coming steps of this round.
    pub coming: Vec<UpcomingStep>,
    /// Number of the round, from 1; 0 before the beginning.
    pub round: u32,
    /// Number of rounds; 0 in a free session.
    pub rounds: u32,
    /// Number of trials of the round that are done.
    pub done: usize,
    /// Number of trials of a round.
    pub trials: usize,
    /// Number of trials that are not used.
    pub bad: u32,
    /// Whether a trial can be repeated.
    pub can_repeat: bool,
    /// Samples from `from` to the end of the session; none in a free session.
    pub left: Option<u64>,
}

/// Number of steps that are shown ahead.
const AHEAD: usize = 6;

impl Session {
    /// State of the session for a page.
    pub fn view(&self) -> View {
        let (phase, why, from, end) = match self.phase {
            Phase::Waiting => ("waiting", None, None, None),
            Phase::Ready { from, end } => ("ready", None, Some(from), Some(end)),
            Phase::Cued { from, end } => ("cued", None, Some(from), end),
            Phase::Held(why) => ("held", Some(why), None, None),
            Phase::Over => ("over", None, None, None),
        };
        let (done, trials) = self.schedule.progress();
        let coming = self.schedule.upcoming().take(AHEAD);
        View {
            phase,
            protocol: self.protocol.name.clone(),
            free: self.protocol.is_free(),
            classes: self.protocol.names(),
            why,
            cue: self.cue.map(Motion::name),
            from: from.map(|at| at.0),
            end: end.map(|at| at.0),
            coming: coming
                .map(|step| UpcomingStep {
                    cue: step.motion.name(),
                    samples: step.samples,
                })
                .collect(),
            round: self.round,
            rounds: self.schedule.rounds(),
            done: if self.round == 0 { 0 } else { done },
            trials,
            bad: self.bad,
            can_repeat: matches!(self.phase, Phase::Cued { .. }) && self.trial > 0,
            left: self.left(),
        }
    }

    /// Samples from the beginning of the present countdown or cue to the end of the session.
    fn left(&self) -> Option<u64> {
        let whole = self.protocol.samples()?;
        let pause = u64::from(self.protocol.pause);
        if self.is_over() {
            return Some(0);
        }
        if self.round == 0 {
            return Some(whole);
        }
        let rest = u64::from(self.schedule.rounds() - self.round);
        let rounds = rest * (pause + self.schedule.round_samples());
        let round: u64 = self
            .schedule
            .upcoming()
            .map(|step| u64::from(step.samples))
            .sum();
        let present = match self.phase {
            Phase::Ready { from, end }
            | Phase::Cued {
                from,
                end: Some(end),
            } => u64::from(end.since(from)),
            _ => pause,
        };
        Some(rounds + round + present)
    }
}
