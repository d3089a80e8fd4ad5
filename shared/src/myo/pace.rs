//! Finds by the clock what the lanes cannot show: a loss of four notifications, or eight ...
//!
//! A notification may be late, never early. So the quickest ones of late give the pace: one every
//! 10 ms. How late a packet is against them is its *lag*. Lanes that skipped four packets make every
//! packet from then on 40 ms late; a radio that stalled makes some late, and then a bunch of them
//! catches up. While that is open, packets are held, not delivered:
//!
//! ```text
//! lag, ms   0  2  1 | 41 40 43 41 40 ...      stays: a loss of four
//!           0  2  1 | 95 85 75 ... 35 | 25    comes back: a stall
//! ```
//!
//! * Below 32 ms a packet is on time: jitter of up to 30 ms is ordinary, and a loss makes 40.
//! * If the lag comes back, everything held is delivered: it follows.
//! * If for 50 ms it neither found a new low nor was there a pause, it is there to stay: packets were lost. Where among those
//!   held nobody can tell (a stall may end in a loss), so all of them are given up with the lost.
//! * If too many are held, they are given up, and the question stays open.
//!
//! The pace follows a quicker packet at once, so that a stream faster than 100/s never seems to
//! lose any, and a slower one by 0.5 % at most, which is more than two crystals differ by.
//!
//! It cannot see a loss of four in a faster stream, or before the first quick packet has set the
//! pace, or just when transmission gets quicker by as much as the loss delays: as in a stall that
//! ends in trickles over more than 50 ms, and was taken for a loss before the true one came.

use super::elapsed;
use super::lane::{LANES, NOTIFICATION_PERIOD_MS};
use super::order::Placed;
use super::sequence::{Ordered, PAIR};
use crate::units::Millis;
use heapless::Vec;

/// Microseconds from a notification to the next.
const PERIOD_US: u32 = NOTIFICATION_PERIOD_MS * 1000;
/// Microseconds that a loss invisible to the lanes adds to the lag.
const TURN_US: u32 = LANES as u32 * PERIOD_US;
/// Lag from which a packet is no longer on time: more than jitter, 30 ms, with two roundings of the
/// clock; less than a loss, 40 ms, with a pace that is known to a few.
const LATE_US: u32 = 32_000;
/// Microseconds of lag forgiven per millisecond: 0.5 %.
const STEERING_US: u32 = 5;
/// A lag without a new low for this long is there to stay. A loss of 13 with this wait is told
/// within the 200 ms after which the stream would count as silent.
const PATIENCE_MS: u32 = 50;
/// A pause that may be a stall with a bunch behind it: longer than jitter makes, shorter than
/// patience, which a bunch must not outlast unseen.
const STALL_MS: u32 = 45;
const _: () = assert!(STALL_MS * 1000 > LATE_US + PERIOD_US - 1 && STALL_MS < PATIENCE_MS);
/// How much lower a new low must be: less may be jitter around a lag that stays.
const GAIN_US: u32 = 5_000;
/// Most packets held: a stall of 200 ms, after which the stream counts as silent anyhow, and some.
const HELD_AT_MOST: usize = 24;
/// Longest pause that is measured: longer ones say no more, and sums stay within u32.
const PAUSE_AT_MOST_MS: u32 = 60_000;

const _: () = assert!(LATE_US < TURN_US);
/// Largest lag, so that no sum of it overflows.
const LAG_AT_MOST_US: u32 = PAUSE_AT_MOST_MS * 1000;
const _: () = assert!(LAG_AT_MOST_US.checked_mul(3).is_some());

/// The pace of one stream.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Pace {
    /// When the newest packet came; none before the first.
    newest: Option<Millis>,
    /// How late it was against the quickest of late.
    lag: u32,
    /// Empty unless `doubt`.
    held: Vec<Placed, HELD_AT_MOST>,
    doubt: Option<Doubt>,
}

/// Since the lag is too large.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Doubt {
    /// The least lag since, in microseconds.
    least: u32,
    /// When a bunch may last have been under way: at a new low, or after a pause.
    at: Millis,
}

impl Pace {
    pub(super) const fn new() -> Self {
        Self {
            newest: None,
            lag: 0,
            held: Vec::new(),
            doubt: None,
        }
    }

    /// Takes the next packet; gives what is sure to be in order, and how many packets it gave up.
    pub(super) fn push(&mut self, placed: Placed, out: &mut impl FnMut(Ordered)) -> u32 {
        let pause = self.measure(placed);
        if self.lag < LATE_US {
            self.doubt = None;
            for waited in core::mem::take(&mut self.held) {
                deliver(waited, out);
            }
            deliver(placed, out);
            return 0;
        }
        let (at, lag) = (placed.at, self.lag);
        let doubt = self.doubt.get_or_insert(Doubt { least: lag, at });
        if lag + GAIN_US <= doubt.least || pause >= STALL_MS {
            doubt.at = at;
        }
        doubt.least = doubt.least.min(lag);
        let Doubt { least, at } = *doubt;
        // Never full here: it is emptied below as soon as it is.
        let held = self.held.push(placed);
        if elapsed(placed.at, at) >= PATIENCE_MS {
            // Rounded down but for the tolerance: what is over is lateness, which is never negative.
            let turns = (least + TURN_US - LATE_US) / TURN_US;
            // The pace may not be later than the quickest packet.
            self.lag -= least.min(turns * TURN_US);
            self.doubt = None;
            self.give_up(turns * u32::from(LANES), out)
        } else if held.is_err() || self.held.is_full() {
            self.give_up(0, out)
        } else {
            0
        }
    }

    /// Takes the packet's time; gives the milliseconds since the one before it.
    fn measure(&mut self, placed: Placed) -> u32 {
        let Some(before) = self.newest.replace(placed.at) else {
            return 0;
        };
        let pause = elapsed(placed.at, before).min(PAUSE_AT_MOST_MS);
        let due = PERIOD_US * (1 + placed.missing);
        let lag = self.lag + pause * (1000 - STEERING_US);
        self.lag = lag.saturating_sub(due).min(LAG_AT_MOST_US);
        pause
    }

    fn give_up(&mut self, unseen: u32, out: &mut impl FnMut(Ordered)) -> u32 {
        let held = self.held.len() as u32;
        let seen: u32 = self.held.iter().map(|placed| placed.missing).sum();
        self.held.clear();
        tell_missing(unseen + seen + held, out);
        held
    }
}

fn deliver(placed: Placed, out: &mut impl FnMut(Ordered)) {
    tell_missing(placed.missing, out);
    out(Ordered::Pair(placed.pair));
}

fn tell_missing(notifications: u32, out: &mut impl FnMut(Ordered)) {
    if notifications > 0 {
        let missing = notifications * PAIR;
        out(Ordered::Gap { missing });
    }
}
