//! Delays before the next connection attempt.

/// Shortest delay. With a shorter one a radio may still be cancelling the failed attempt, and cancel
/// the next one with it.
const SHORTEST_MS: u32 = 300;
/// Longest delay after ordinary failures.
const LONGEST_MS: u32 = 5_000;
/// Delay after a refused armband: it would be refused again.
pub(super) const REFUSED_MS: u32 = 60_000;

/// Exponential back-off: delays double from failure to failure, 0.3 s to 5 s.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct BackOff {
    next_ms: u32,
}

impl BackOff {
    pub(super) const fn new() -> Self {
        Self {
            next_ms: SHORTEST_MS,
        }
    }

    /// The delay after a failure, in milliseconds.
    pub(super) const fn delay(&mut self) -> u32 {
        let delay = self.next_ms;
        let doubled = 2 * delay;
        self.next_ms = if doubled < LONGEST_MS {
            doubled
        } else {
            LONGEST_MS
        };
        delay
    }

    /// The connection worked: the next delay is the shortest.
    pub(super) const fn reset(&mut self) {
        *self = Self::new();
    }
}
