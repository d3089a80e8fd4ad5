//! From notifications of four lanes to one stream, with its losses told.
//!
//! ```text
//! Arrival -> duplicates -> Order --Placed--> Pace -> Ordered
//!            dropped       by lane           by time
//! ```
//!
//! A notification in sequence and on time comes out at once. What is not sure waits; contiguity is
//! never claimed across a loss, except where lanes and times do not hold the answer: see the limits
//! in [`order`](super::order) and [`pace`](super::pace), and the generator in the tests' truth model,
//! which is restricted by these limits and by nothing else.

use super::counters::{Counters, count};
use super::elapsed;
use super::order::{Arrival, Order, Outcome};
use super::pace::Pace;
use super::packet::Pair;

/// Samples of a notification.
pub(super) const PAIR: u32 = 2;
/// A repeated lane with the very same bytes within this time is a duplicate; else it is a loss of
/// three, which takes 40 ms where the stream keeps its pace.
const DUPLICATE_WITHIN_MS: u32 = 20;

/// What comes out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Ordered {
    /// Two samples that follow what came out before.
    Pair(Pair),
    /// That many samples are missing here, never 0.
    Gap { missing: u32 },
}

/// One stream, from subscription to disconnect.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Sequence {
    newest: Option<Arrival>,
    order: Order,
    pace: Pace,
}

impl Sequence {
    pub(super) const fn new() -> Self {
        Self {
            newest: None,
            order: Order::new(),
            pace: Pace::new(),
        }
    }

    /// Takes the next notification; tells what is sure by now, oldest first.
    pub(super) fn push(
        &mut self,
        arrival: Arrival,
        counters: &mut Counters,
        out: &mut impl FnMut(Ordered),
    ) {
        if self.is_duplicate(arrival) {
            count(&mut counters.duplicates, 1);
            return;
        }
        self.newest = Some(arrival);
        let (mut lost, mut given_up) = (0, 0);
        let outcome = self.order.push(arrival, &mut |placed| {
            given_up += self.pace.push(placed, &mut |ordered| {
                if let Ordered::Gap { missing } = ordered {
                    lost += missing;
                }
                out(ordered);
            });
        });
        match outcome {
            Outcome::Ordinary => {}
            Outcome::Reordered => count(&mut counters.reordered, 1),
            Outcome::Dropped => given_up += 1,
        }
        count(&mut counters.lost, lost);
        count(&mut counters.given_up, given_up * PAIR);
    }

    fn is_duplicate(&self, arrival: Arrival) -> bool {
        self.newest.is_some_and(|newest| {
            (newest.lane, newest.pair) == (arrival.lane, arrival.pair)
                && elapsed(arrival.at, newest.at) < DUPLICATE_WITHIN_MS
        })
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth;
