//! Orders the notifications of four lanes into one stream of samples and gaps.
//!
//! ```text
//! Arrival -> duplicates -> Order --Placed--> ArrivalTiming -> Ordered
//!            dropped       by lane           by time
//! ```
//!
//! A notification in sequence and in time is delivered at once. Others are held until their place is
//! known. Samples are never delivered as contiguous across a loss that lanes and arrival times show;
//! what they cannot show is listed in [`order`](super::order) and
//! [`arrival_timing`](super::arrival_timing). The tests generate impaired streams within these limits
//! and no others.

use super::arrival_timing::{ArrivalTiming, Ordered};
use super::counters::{Counters, count};
use super::order::{Arrival, Order, OrderOutcome};
use super::packet::PAIR_SAMPLES;

/// A repeated lane with the same bytes within this time is a duplicate. Later it is a loss of three,
/// which takes 40 ms in a stream without delay.
const DUPLICATE_WITHIN_MS: u32 = 20;

/// State of one stream, from subscription to disconnection.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Sequence {
    newest: Option<Arrival>,
    order: Order,
    timing: ArrivalTiming,
}

impl Sequence {
    pub(super) const fn new() -> Self {
        Self {
            newest: None,
            order: Order::new(),
            timing: ArrivalTiming::new(),
        }
    }

    /// Takes the next notification; delivers what is certain by now, oldest first.
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
            given_up += self.timing.push(placed, &mut |ordered| {
                if let Ordered::Gap { missing } = ordered {
                    lost += missing;
                }
                out(ordered);
            });
        });
        match outcome {
            OrderOutcome::InOrder => {}
            OrderOutcome::Reordered => count(&mut counters.reordered, 1),
            OrderOutcome::Dropped => given_up += 1,
        }
        count(&mut counters.lost, lost);
        count(&mut counters.given_up, given_up * PAIR_SAMPLES);
    }

    fn is_duplicate(&self, arrival: Arrival) -> bool {
        self.newest.is_some_and(|newest| {
            (newest.lane, newest.pair) == (arrival.lane, arrival.pair)
                && arrival.at.elapsed_since(newest.at) < DUPLICATE_WITHIN_MS
        })
    }
}

#[cfg(test)]
mod impairments;
#[cfg(test)]
mod tests;
