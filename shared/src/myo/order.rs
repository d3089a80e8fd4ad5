//! Restores the order of two swapped notifications, and counts by lane how many are missing.
//!
//! After `p` the lane of `p + 1` is due. If the lane of `p + 2` comes instead, `p + 1` is lost or the
//! two are swapped: `p + 2` is held for the next one or two notifications.
//!
//! | the next lane is that of | and the one after that of | it was |
//! | --- | --- | --- |
//! | `p + 1` | `p + 3` | a swap, as far as lanes show |
//! | `p + 1` | another | a loss of `p + 1`; the one in its lane is dropped, since it may be a late one |
//! | another | | a loss of `p + 1` |
//!
//! At most two notifications are held, and every new one decides, so there is no time-out. A
//! notification that is overtaken by more than one other looks like a loss.

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

/// A notification in its place, as far as lanes show.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Placed {
    /// Time at which its place was known: its arrival or later.
    pub at: Millis,
    /// Notifications missing right before it, 0..=3; any multiple of four more may be.
    pub missing: u32,
    pub pair: Pair,
}

/// Result of one arrival.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum OrderOutcome {
    /// Nothing to count.
    InOrder,
    /// Two notifications were swapped.
    Reordered,
    /// A notification that may have been late was dropped; its place counts as missing.
    Dropped,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Held {
    Nothing,
    /// `p + 2`, where `p + 1` was due.
    Early(Arrival),
    /// `p + 2`, and after it one in the lane of `p + 1`.
    Swapped {
        early: Arrival,
        late: Arrival,
    },
}

/// The order of one stream.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Order {
    /// The lane that is due; none before the first notification, which may have any.
    due: Option<Lane>,
    held: Held,
}

impl Order {
    pub(super) const fn new() -> Self {
        Self {
            due: None,
            held: Held::Nothing,
        }
    }

    /// Takes the next notification; places up to three, oldest first.
    pub(super) fn push(
        &mut self,
        arrival: Arrival,
        place: &mut impl FnMut(Placed),
    ) -> OrderOutcome {
        match core::mem::replace(&mut self.held, Held::Nothing) {
            Held::Nothing => self.take(arrival, place),
            Held::Early(early) => {
                if self.due == Some(arrival.lane) {
                    let late = arrival;
                    self.held = Held::Swapped { early, late };
                    return OrderOutcome::InOrder;
                }
                self.put(early, place);
                self.take(arrival, place);
            }
            Held::Swapped { early, late } => {
                if arrival.lane == early.lane.next() {
                    // Both get the time of the arrival that decided: if it is a loss of four, all
                    // three must have the same lag.
                    for arrived in [late, early, arrival] {
                        let at = arrival.at;
                        self.put(Arrival { at, ..arrived }, place);
                    }
                    return OrderOutcome::Reordered;
                }
                self.put(early, place);
                self.take(arrival, place);
                return OrderOutcome::Dropped;
            }
        }
        OrderOutcome::InOrder
    }

    /// Places the notification, or holds it, while none is held.
    fn take(&mut self, arrival: Arrival, place: &mut impl FnMut(Placed)) {
        if self.missing_before(arrival) == 1 {
            self.held = Held::Early(arrival);
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

    /// Pushes numbered notifications, each at its due time, and returns what was placed: the number,
    /// and how many are missing before it.
    fn place(numbers: &[u8]) -> (Vec<(u8, u32)>, Vec<OrderOutcome>) {
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
        let outcomes = outcomes
            .filter(|one| *one != OrderOutcome::InOrder)
            .collect();
        (placed, outcomes)
    }

    #[test]
    fn notifications_are_placed_as_the_table_says() {
        use OrderOutcome::{Dropped, Reordered};
        type Row<'a> = (&'a [u8], &'a [(u8, u32)], &'a [OrderOutcome]);
        let table: [Row; 9] = [
            (&[2, 3, 4, 5], &[(2, 0), (3, 0), (4, 0), (5, 0)], &[]),
            (&[0, 2], &[(0, 0)], &[]), // 2 is held
            (&[0, 2, 3], &[(0, 0), (2, 1), (3, 0)], &[]),
            (&[0, 3, 4], &[(0, 0), (3, 2), (4, 0)], &[]),
            (&[0, 4, 5], &[(0, 0), (4, 3), (5, 0)], &[]),
            (&[0, 2, 1], &[(0, 0)], &[]), // both are held
            (
                &[0, 2, 1, 3],
                &[0, 1, 2, 3].map(|number| (number, 0)),
                &[Reordered],
            ),
            // 1, 3 and 4 are lost: 5 comes in the lane of 1 and is dropped.
            (&[0, 2, 5, 6], &[(0, 0), (2, 1), (6, 3)], &[Dropped]),
            (&[0, 2, 4, 5], &[(0, 0), (2, 1), (4, 1), (5, 0)], &[]),
        ];
        for (numbers, expected, outcomes) in table {
            let found = place(numbers);
            assert_eq!(found, (expected.to_vec(), outcomes.to_vec()), "{numbers:?}");
        }
    }

    #[test]
    fn swapped_notifications_get_the_time_of_the_one_that_decides() {
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
