//! Lost samples: filled in where they are few, and otherwise the end of the window.

use super::{Pipeline, Reports};
use crate::model::Encode;
use crate::stream::ring::Origin;
use crate::stream::safe_state::SafetyEvent;
use crate::units::Millis;

/// Most consecutive lost samples that are filled in, by repeating the last sample before them.
const MAX_BRIDGED: u32 = 5;

/// Most samples of a window of 600 that are filled in: 10 %. What that costs was measured: docs/decisions.md.
const MAX_BRIDGED_OF_WINDOW: u32 = 60;

impl<E: Encode> Pipeline<'_, E> {
    /// Samples are missing before the next one: up to 5 are filled in, more reset the window. So do fewer
    /// with which more than 60 of the window's 600 samples would have been filled in.
    pub fn gap(&mut self, now: Millis, missing: u32) -> Reports {
        let mut reports = self.tick(now);
        self.counters.lost = self.counters.lost.saturating_add(missing);
        match self.last {
            Some(last) if self.may_be_bridged(missing) => {
                self.counters.bridged = self.counters.bridged.saturating_add(missing);
                // A patch a call at most, however far the encoder is behind: the next sample is due.
                let mut encoded = false;
                for _ in 0..missing {
                    self.push(last, Origin::Bridged);
                    encoded = encoded || self.encode(now, &mut reports);
                }
            }
            Some(_) => {
                self.skip(missing);
                self.reset_window();
                let short = missing <= MAX_BRIDGED;
                let event = if short {
                    SafetyEvent::Losses
                } else {
                    SafetyEvent::Gap
                };
                self.handle(now, event, &mut reports);
            }
            // No sample since the last reset: the window is empty.
            None => self.skip(missing),
        }
        reports
    }

    /// Whether a gap is short, and the window within its quota with it.
    const fn may_be_bridged(&self, missing: u32) -> bool {
        missing <= MAX_BRIDGED && self.ring.bridged() + missing <= MAX_BRIDGED_OF_WINDOW
    }

    /// Passes over the positions of samples that are missing.
    const fn skip(&mut self, missing: u32) {
        if missing > 0 {
            self.newest = self.next.plus(missing - 1);
            self.next = self.newest.plus(1);
        }
    }
}
