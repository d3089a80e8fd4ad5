//! What a page shows of a session: as data, in samples of the stream.

use serde::Serialize;
use shared::intent::Intent;

use super::{Held, Phase, Session};
use crate::record::protocol::Course;

/// Steps that are shown ahead.
const AHEAD: usize = 6;

/// A step that comes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct Coming {
    /// What will be asked for.
    pub cue: &'static str,
    /// For how long.
    pub samples: u32,
}

/// Where a session is.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct View {
    /// `waiting`, `ready`, `cued`, `held` or `over`.
    pub phase: &'static str,
    /// Name of the protocol.
    pub protocol: String,
    /// Whether the person says what is done.
    pub free: bool,
    /// Classes that occur.
    pub classes: Vec<&'static str>,
    /// Why it waits, if it is held.
    pub why: Option<Held>,
    /// What is asked for.
    pub cue: Option<&'static str>,
    /// First sample of the countdown or the cue.
    pub from: Option<u32>,
    /// Its last sample, and one; none in a free session.
    pub end: Option<u32>,
    /// What comes next, in this round.
    pub coming: Vec<Coming>,
    /// From 1 on; 0 before the beginning.
    pub round: u32,
    /// How many there are; 0 in a free session.
    pub rounds: u32,
    /// Trials of the round that are done.
    pub done: usize,
    /// Trials of a round.
    pub trials: usize,
    /// Trials that are not used.
    pub bad: u32,
    /// Whether a trial can be repeated.
    pub can_repeat: bool,
    /// Samples to the end, from `from` on; none in a free session.
    pub left: Option<u64>,
}

impl Session {
    /// Where the session is.
    #[must_use]
    pub fn view(&self) -> View {
        let (phase, why, from, end) = match self.phase {
            Phase::Waiting => ("waiting", None, None, None),
            Phase::Ready { from, end } => ("ready", None, Some(from), Some(end)),
            Phase::Cued { from, end } => ("cued", None, Some(from), end),
            Phase::Held(why) => ("held", Some(why), None, None),
            Phase::Over => ("over", None, None, None),
        };
        let (done, trials) = self.guided.progress();
        let coming = self.guided.coming().take(AHEAD);
        View {
            phase,
            protocol: self.protocol.name.clone(),
            free: matches!(self.protocol.course, Course::Free { .. }),
            classes: self
                .protocol
                .intents()
                .into_iter()
                .map(Intent::name)
                .collect(),
            why,
            cue: self.cue.map(Intent::name),
            from: from.map(|at| at.0),
            end: end.map(|at| at.0),
            coming: coming
                .map(|step| Coming {
                    cue: step.intent.name(),
                    samples: step.samples,
                })
                .collect(),
            round: self.round,
            rounds: self.guided.rounds(),
            done: if self.round == 0 { 0 } else { done },
            trials,
            bad: self.bad,
            can_repeat: matches!(self.phase, Phase::Cued { .. }) && self.trial > 0,
            left: self.left(),
        }
    }

    /// Samples to the end, from the beginning of the present countdown or cue on.
    fn left(&self) -> Option<u64> {
        let whole = self.protocol.samples()?;
        let pause = u64::from(self.protocol.pause);
        if self.is_over() {
            return Some(0);
        }
        if self.round == 0 {
            return Some(whole);
        }
        let rest = u64::from(self.guided.rounds() - self.round);
        let rounds = rest * (pause + self.guided.round_samples());
        let round: u64 = self
            .guided
            .coming()
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
