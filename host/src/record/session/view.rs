//! View of a session for a page, in samples of the stream.

use recordings::labels::motion::Motion;
use web::session::{UpcomingStep, View};

use super::{Phase, Session};

/// Number of steps that are shown ahead.
const AHEAD: usize = 6;

impl Session {
    /// State of the session for a page.
    pub(crate) fn view(&self) -> View {
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
