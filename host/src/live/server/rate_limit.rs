//! Rate limit of one viewer's requests, so that none takes the time and the messages of the others.

use std::time::{Duration, Instant};

/// Burst of requests: a page asks for the time four times, and a person may be quick.
const AT_ONCE: u32 = 20;
/// Time in which one more request is allowed: 10 a second.
const EACH: Duration = Duration::from_millis(100);
/// Pause between two answers to excess requests.
const REFUSAL_PAUSE: Duration = Duration::from_secs(1);

/// Rate limit: how many requests a viewer has left.
#[derive(Debug)]
pub(super) struct RateLimit {
    left: u32,
    /// Time at which `left` was counted.
    at: Instant,
    /// Time of the last refusal.
    refused: Option<Instant>,
}

/// Decision about a request of a viewer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Admission {
    Admitted,
    /// Excess request; the viewer is to be told.
    Refused,
    /// Excess request; the viewer was told just now.
    Ignored,
}

impl RateLimit {
    pub(super) const fn new(now: Instant) -> Self {
        Self {
            left: AT_ONCE,
            at: now,
            refused: None,
        }
    }

    /// Decides about a request.
    pub(super) fn admit(&mut self, now: Instant) -> Admission {
        let passed = now.saturating_duration_since(self.at).as_millis() / EACH.as_millis();
        let passed = u32::try_from(passed).unwrap_or(u32::MAX);
        if passed >= AT_ONCE - self.left {
            (self.left, self.at) = (AT_ONCE, now);
        } else {
            self.left += passed;
            self.at += passed * EACH;
        }
        if self.left > 0 {
            self.left -= 1;
            return Admission::Admitted;
        }
        let is_new = |refused| now.saturating_duration_since(refused) >= REFUSAL_PAUSE;
        if self.refused.is_none_or(is_new) {
            self.refused = Some(now);
            return Admission::Refused;
        }
        Admission::Ignored
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_at_once_and_then_ten_a_second_are_heard_and_the_rest_is_told_once_a_second() {
        let began = Instant::now();
        let mut rate_limit = RateLimit::new(began);
        let mut count = |from: u64, to: u64| {
            let mut counts = [0; 3];
            for ms in from..to {
                counts[rate_limit.admit(began + Duration::from_millis(ms)) as usize] += 1;
            }
            counts
        };
        assert_eq!(count(0, 1), [1, 0, 0]);
        let [yes, refused, ignored] = count(1, 10_000);
        assert_eq!(yes, 19 + 99);
        assert_eq!(refused, 10);
        assert_eq!(ignored, 9_999 - yes - refused);
        // A pause allows no more than the burst.
        assert_eq!(count(60_000, 60_050)[0], 20);
    }
}
