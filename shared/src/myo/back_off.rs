//! How long to rest before the next attempt.

/// The shortest rest. Below it a radio may still be cancelling the failed connect and cancel the
/// next one with it, and so on.
const SHORTEST_MS: u32 = 300;
/// The longest rest after ordinary failures.
const LONGEST_MS: u32 = 5_000;
/// The rest after a refusal: it would be the same again.
pub(super) const REFUSED_MS: u32 = 60_000;

/// Rests that double from failure to failure, 0.3 s to 5 s.
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

    /// The rest that is due now, in milliseconds.
    pub(super) const fn rest(&mut self) -> u32 {
        let rest = self.next_ms;
        let doubled = 2 * rest;
        self.next_ms = if doubled < LONGEST_MS {
            doubled
        } else {
            LONGEST_MS
        };
        rest
    }

    /// All went well.
    pub(super) const fn reset(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rests_double_up_to_five_seconds_and_start_again() {
        let mut back_off = BackOff::new();
        let rests = [(); 7].map(|()| back_off.rest());
        assert_eq!(rests, [300, 600, 1200, 2400, 4800, 5000, 5000]);
        back_off.reset();
        assert_eq!(back_off.rest(), 300);
    }
}
