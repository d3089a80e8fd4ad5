//! State of a recording session for a page, in samples of the stream.

use serde::Serialize;

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
