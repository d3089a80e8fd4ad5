//! Puts neighbours that swapped places right, and counts what is missing by the lanes.
//!
//! After `p` the lane of `p + 1` is due. The lane of `p + 2` instead means that `p + 1` is lost, or
//! that the two swapped places: that packet waits for the next one or two.
//!
//! | then comes the lane of | and then that of | it was |
//! | --- | --- | --- |
//! | `p + 1` | `p + 3` | a swap, as far as lanes can tell |
//! | `p + 1` | another | a loss of `p + 1`; what came in its lane is dropped, for it may be late |
//! | another | | a loss of `p + 1` |
//!
//! Nothing newer ever waits behind it, so there is no hurry and no time-out. What overtakes by more
//! than one place cannot be told from a loss.

use super::lane::Lane;
use super::packet::Pair;
use crate::units::Millis;

/// An EMG notification.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Arrival {
    pub at: Millis,
    pub lane: Lane,
    pub pair: Pair,
}

/// A notification in its place, as far as lanes can tell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Placed {
    /// When its place was known: not before it came.
    pub at: Millis,
    /// Notifications missing right before it, 0..=3; any multiple of four more may be.
    pub missing: u32,
    pub pair: Pair,
}

/// What came about by placing one arrival.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Outcome {
    /// Nothing to tell.
    Ordinary,
    /// Two neighbours had swapped places.
    Reordered,
    /// A packet that may have been late was dropped; its place is counted as missing.
    Dropped,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Waiting {
    Nothing,
    /// `p + 2` came where `p + 1` was due.
    Early(Arrival),
    /// And then the lane of `p + 1`.
    Swapped {
        early: Arrival,
        late: Arrival,
    },
}

/// The order of one stream.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Order {
    /// The lane that is due; none before the first packet, which may have any.
    due: Option<Lane>,
    waiting: Waiting,
}

impl Order {
    pub(super) const fn new() -> Self {
        Self {
            due: None,
            waiting: Waiting::Nothing,
        }
    }

    /// Takes the next packet; places up to three, oldest first.
    pub(super) fn push(&mut self, arrival: Arrival, place: &mut impl FnMut(Placed)) -> Outcome {
        match core::mem::replace(&mut self.waiting, Waiting::Nothing) {
            Waiting::Nothing => self.take(arrival, place),
            Waiting::Early(early) => {
                if self.due == Some(arrival.lane) {
                    let late = arrival;
                    self.waiting = Waiting::Swapped { early, late };
                    return Outcome::Ordinary;
                }
                self.put(early, place);
                self.take(arrival, place);
            }
            Waiting::Swapped { early, late } => {
                if arrival.lane == early.lane.next() {
                    // Both get the time of the packet that decided: were it a loss of four that
                    // only looks like a swap, all three must look as late as that one.
                    for arrived in [late, early, arrival] {
                        let at = arrival.at;
                        self.put(Arrival { at, ..arrived }, place);
                    }
                    return Outcome::Reordered;
                }
                self.put(early, place);
                self.take(arrival, place);
                return Outcome::Dropped;
            }
        }
        Outcome::Ordinary
    }

    /// With nothing waiting: places the packet, or lets it wait.
    fn take(&mut self, arrival: Arrival, place: &mut impl FnMut(Placed)) {
        if self.missing_before(arrival) == 1 {
            self.waiting = Waiting::Early(arrival);
        } else {
            self.put(arrival, place);
        }
    }

    fn put(&mut self, arrival: Arrival, place: &mut impl FnMut(Placed)) {
        let missing = self.missing_before(arrival);
        self.due = Some(arrival.lane.next());
        let Arrival { at, pair, .. } = arrival;
        place(Placed { at, missing, pair });
    }

    fn missing_before(&self, arrival: Arrival) -> u32 {
        self.due.map_or(0, |due| arrival.lane.missing_since(due))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Feeds numbered packets, each when it would be due, and gives what was placed: the number,
    /// and how many are missing before it.
    fn place(numbers: &[u8]) -> (Vec<(u8, u32)>, Vec<Outcome>) {
        let mut order = Order::new();
        let mut placed = Vec::new();
        let outcomes = numbers.iter().map(|number| {
            let arrival = Arrival {
                at: Millis(u32::from(*number) * 10),
                lane: Lane::new(number % 4).unwrap(),
                pair: [[*number as i8; 8]; 2],
            };
            order.push(arrival, &mut |one: Placed| {
                placed.push((one.pair[0][0] as u8, one.missing));
            })
        });
        let outcomes = outcomes.filter(|one| *one != Outcome::Ordinary).collect();
        (placed, outcomes)
    }

    #[test]
    fn packets_are_placed_as_the_table_says() {
        use Outcome::{Dropped, Reordered};
        type Row<'a> = (&'a [u8], &'a [(u8, u32)], &'a [Outcome]);
        let table: [Row; 9] = [
            (&[2, 3, 4, 5], &[(2, 0), (3, 0), (4, 0), (5, 0)], &[]),
            (&[0, 2], &[(0, 0)], &[]), // 2 waits
            (&[0, 2, 3], &[(0, 0), (2, 1), (3, 0)], &[]),
            (&[0, 3, 4], &[(0, 0), (3, 2), (4, 0)], &[]),
            (&[0, 4, 5], &[(0, 0), (4, 3), (5, 0)], &[]),
            (&[0, 2, 1], &[(0, 0)], &[]), // both wait
            (
                &[0, 2, 1, 3],
                &[(0, 0), (1, 0), (2, 0), (3, 0)],
                &[Reordered],
            ),
            // 1 and then 3, 4 lost: 5 comes in the lane of 1 and pays for the doubt.
            (&[0, 2, 5, 6], &[(0, 0), (2, 1), (6, 3)], &[Dropped]),
            (
                &[0, 2, 4, 6, 7],
                &[(0, 0), (2, 1), (4, 1), (6, 1), (7, 0)],
                &[],
            ),
        ];
        for (numbers, expected, outcomes) in table {
            let found = place(numbers);
            assert_eq!(found, (expected.to_vec(), outcomes.to_vec()), "{numbers:?}");
        }
    }

    #[test]
    fn swapped_packets_are_as_late_as_the_one_that_tells() {
        let mut order = Order::new();
        let mut times = Vec::new();
        for (at, number) in [(0, 0), (20, 2), (21, 1), (33, 3), (40, 0)] {
            let lane = Lane::new(number).unwrap();
            let (at, pair) = (Millis(at), [[0; 8]; 2]);
            let arrival = Arrival { at, lane, pair };
            order.push(arrival, &mut |placed: Placed| times.push(placed.at.0));
        }
        assert_eq!(times, [0, 33, 33, 33, 40]);
    }
}
