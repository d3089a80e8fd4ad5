//! Inputs and outputs of a session.

use super::HoldReason;
use recordings::labels::motion::Motion;
use shared::units::SampleIndex;

/// Input of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// Samples from the source.
    Samples {
        /// Index of the first sample.
        first: SampleIndex,
        /// Number of samples.
        count: u32,
    },
    /// Passage of time.
    Tick,
    /// Hold of the session until the person continues.
    Hold(HoldReason),
    /// Action of the person.
    Action(Action),
}

/// Action of the person.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Begin or continue.
    Begin,
    /// Reject the last trial and repeat it.
    Repeat,
    /// Hold the session.
    Hold,
    /// End the session.
    Finish,
    /// Name the gesture done from now on, in a free session.
    #[serde(skip)]
    Mark(Motion),
}

/// Reason why a trial is not used.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RejectReason {
    /// The person rejected it.
    Person,
    /// The trial was interrupted.
    Interrupted,
    /// More samples in a row were lost than can be bridged.
    Lost,
}

/// Output for the journal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Output {
    /// Round: a new recording begins at a sample.
    Round {
        /// Number of the round, from 1.
        number: u32,
        /// First sample of the round.
        at: SampleIndex,
    },
    /// Cue from a sample on; none for a pause.
    Cue {
        /// First sample of the cue.
        at: SampleIndex,
        /// Motion to perform.
        cue: Option<Motion>,
        /// Number of the attempt, counted over all trials from 1; 0 outside of trials.
        trial: u32,
    },
    /// Rejection of a trial.
    Rejected {
        /// Number of the trial.
        trial: u32,
        /// Reason.
        why: RejectReason,
    },
    /// Pause, or the early end of a guided session: samples are not kept until the next round or cue.
    Pause,
    /// End of a session that was carried out.
    Over,
}
