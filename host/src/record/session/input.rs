//! What happens to a session, and what it says.

use shared::intent::Intent;
use shared::units::SampleIndex;

/// What happened.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// Samples have come.
    Samples {
        /// Index of the first.
        first: SampleIndex,
        /// How many.
        count: u32,
    },
    /// Time has passed.
    Tick,
    /// The session cannot go on, until the person says so.
    Hold(Held),
    /// What the person says.
    Action(Action),
}

/// What a person says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action {
    /// Begin, or go on.
    Begin,
    /// The last trial was bad: again.
    Repeat,
    /// Wait.
    Hold,
    /// That is all.
    Finish,
    /// Free: this is done from now on.
    Mark(Intent),
}

/// Why a session waits.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Held {
    /// The person asked for it.
    Person,
    /// Nobody looks at the cues any more.
    LeaderLeft,
    /// The source is gone, or began anew.
    SourceLost,
    /// No sample for two seconds.
    Silent,
    /// Several trials in a row had lost samples.
    Losses,
    /// What comes cannot be written down.
    Disk,
    /// What was written down was deleted, moved or replaced.
    Gone,
}

/// Why a trial is not used.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bad {
    /// The person said so.
    Person,
    /// It was interrupted.
    Interrupted,
    /// More samples in a row were lost than can be bridged.
    Lost,
}

/// What is to be written down.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Output {
    /// A round begins at a sample: a recording of its own.
    Round {
        /// From 1 on.
        number: u32,
        /// Its first sample.
        at: SampleIndex,
    },
    /// From a sample on this is asked for; nothing, if none.
    Cue {
        /// First sample of the cue.
        at: SampleIndex,
        /// What is asked for.
        cue: Option<Intent>,
        /// Counts all attempts at all trials, from 1 on; 0 outside.
        trial: u32,
    },
    /// A trial is not to be used.
    Bad {
        /// Its number.
        trial: u32,
        /// Why.
        why: Bad,
    },
    /// Samples are not kept until the next round or cue.
    Pause,
    /// That was all.
    Over,
}
