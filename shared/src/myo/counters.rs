//! What a session has lived through.

/// Counts since the session began, over all its connections. They stop at their maximum.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counters {
    /// Connections made.
    pub connections: u32,
    /// Attempts to connect that failed.
    pub failed_connects: u32,
    /// Operations that were not answered in time.
    pub timeouts: u32,
    /// Streams given up because nothing came for a second.
    pub stalls: u32,
    /// Set-ups in which a step failed, or a characteristic was missing.
    pub failed_set_ups: u32,
    /// Armbands refused for their firmware.
    pub refused: u32,
    /// EMG notifications taken in, duplicates included.
    pub notifications: u32,
    /// Samples reported missing, those given up included.
    pub lost: u32,
    /// Samples that came and were dropped, because their place among lost ones could not be told.
    pub given_up: u32,
    /// Notifications that came twice.
    pub duplicates: u32,
    /// Pairs of neighbours that came in the wrong order and were put right.
    pub reordered: u32,
    /// Values too short to be what they should be.
    pub malformed: u32,
    /// Notifications that nobody waits for: of no stream, or of a characteristic that never should.
    pub foreign: u32,
}

/// Adds to a counter that stops at its maximum.
pub(super) const fn count(counter: &mut u32, more: u32) {
    *counter = counter.saturating_add(more);
}
