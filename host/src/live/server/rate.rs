//! How often one viewer may ask for something, so that no one takes the time and the messages of the others.

use std::time::{Duration, Instant};

/// Requests at once: a page asks for the time four times, and a person is quick.
const AT_ONCE: u32 = 20;
/// Between two requests of one that goes on asking: 10 a second.
const EACH: Duration = Duration::from_millis(100);
/// Between two answers that it was too often.
const TOLD: Duration = Duration::from_secs(1);

/// What a viewer may still ask for.
#[derive(Debug)]
pub(super) struct Rate {
    left: u32,
    /// When `left` was counted.
    at: Instant,
    /// When the viewer was told last that it asks too often.
    told: Option<Instant>,
}

/// Whether a request is heard.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Heard {
    Yes,
    /// Too often, and the viewer is to be told so.
    Refused,
    /// Too often, and it was told so just now.
    Ignored,
}

impl Rate {
    pub(super) const fn new(now: Instant) -> Self {
        Self {
            left: AT_ONCE,
            at: now,
            told: None,
        }
    }

    /// A request comes.
    pub(super) fn ask(&mut self, now: Instant) -> Heard {
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
            return Heard::Yes;
        }
        let is_new = |told| now.saturating_duration_since(told) >= TOLD;
        if self.told.is_none_or(is_new) {
            self.told = Some(now);
            return Heard::Refused;
        }
        Heard::Ignored
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_at_once_and_then_ten_a_second_are_heard_and_the_rest_is_told_once_a_second() {
        let began = Instant::now();
        let mut rate = Rate::new(began);
        let mut count = |from: u64, to: u64| {
            let mut heard = [0; 3];
            for ms in from..to {
                heard[rate.ask(began + Duration::from_millis(ms)) as usize] += 1;
            }
            heard
        };
        assert_eq!(count(0, 1), [1, 0, 0]);
        let [yes, refused, ignored] = count(1, 10_000);
        assert_eq!(yes, 19 + 99);
        assert_eq!(refused, 10);
        assert_eq!(ignored, 9_999 - yes - refused);
        // After a pause no more than at first.
        assert_eq!(count(60_000, 60_050)[0], 20);
    }
}
