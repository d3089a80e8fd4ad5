//! Event counts of a session.

/// Counts since the session began, over all its connections. A count stays at its maximum.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counters {
    /// Connections made.
    pub connections: u32,
    /// Attempts to connect that failed.
    pub failed_connects: u32,
    /// Operations without an answer within 5 s.
    pub timeouts: u32,
    /// Connections closed because no EMG arrived for a second.
    pub stalls: u32,
    /// Set-ups with a failed step or a missing characteristic.
    pub failed_set_ups: u32,
    /// Armbands refused because of their firmware version.
    pub refused: u32,
    /// EMG notifications received, duplicates included.
    pub notifications: u32,
    /// Samples reported missing, those of `given_up` included.
    pub lost: u32,
    /// Samples received but discarded, because their position among lost ones is unknown.
    pub given_up: u32,
    /// Duplicate notifications.
    pub duplicates: u32,
    /// Pairs of notifications received in the wrong order and swapped back.
    pub reordered: u32,
    /// Values shorter than their minimum length.
    pub malformed: u32,
    /// Unexpected notifications: outside a stream, or of a characteristic without subscription.
    pub foreign: u32,
}

/// Adds to a counter that stays at its maximum.
pub(super) const fn count(counter: &mut u32, more: u32) {
    *counter = counter.saturating_add(more);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_stays_at_its_maximum() {
        let mut counter = u32::MAX - 2;
        count(&mut counter, 1);
        assert_eq!(counter, u32::MAX - 1);
        for more in [2, 1, u32::MAX] {
            count(&mut counter, more);
            assert_eq!(counter, u32::MAX);
        }
    }
}
