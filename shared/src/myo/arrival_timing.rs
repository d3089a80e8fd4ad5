//! Detects by arrival times what the lanes cannot show: a loss of four notifications, or eight, ...
//!
//! A notification may arrive late, never early: one is due every 10 ms after the quickest of the
//! recent ones. The *lag* is how much later than that a notification arrives. A loss of four, which
//! skips one cycle of the lanes, makes every later notification 40 ms late. A stall of the radio makes
//! some late, and a burst then catches up. Until it is clear which of the two happened,
//! notifications are held, not delivered:
//!
//! ```text
//! lag, ms   0  2  1 | 41 40 43 41 40 ...      stays: a loss of four
//!           0  2  1 | 95 85 75 ... 35 | 25    returns: a stall
//! ```
//!
//! * A lag below 32 ms is in time: jitter of up to 30 ms is ordinary, and a loss makes 40 ms.
//! * If the lag returns below that, all held notifications are delivered, in order.
//! * If for 50 ms the lag reached no new minimum and there was no pause, notifications were lost. The
//!   position of the loss among those held is unknown (a stall may end in a loss), so all held ones
//!   are discarded and count as lost too.
//! * If too many are held, they are discarded, and the decision stays open.
//!
//! An earlier notification moves the due times at once, so a stream faster than 100 notifications a
//! second never seems to lose any. A later one moves them by at most 0.5 %, more than the difference
//! of two crystals.
//!
//! Limits: a loss of four is not detected in a stream that is faster than 100/s, nor before the first
//! notification without delay has set the due times, nor where the delay shrinks at the same time by as much as the loss
//! adds: in a stall that ends in bursts more than 50 ms apart, and was taken for a loss before the true
//! one came.

use super::lane::{LANES, NOTIFICATION_PERIOD_MS};
use super::order::Placed;
use super::packet::{PAIR_SAMPLES, Pair};
use crate::units::Millis;
use heapless::Vec;

/// Microseconds from a notification to the next.
const PERIOD_US: u32 = NOTIFICATION_PERIOD_MS * 1000;
/// Microseconds of lag that a loss invisible to the lanes adds: one cycle of the lanes.
const CYCLE_US: u32 = LANES as u32 * PERIOD_US;
/// Lag from which a notification is late: more than jitter, 30 ms, with two roundings of the clock;
/// less than a loss, 40 ms, with due times known to a few ms.
const LATE_US: u32 = 32_000;
/// Microseconds of lag forgiven per millisecond: 0.5 %.
const DRIFT_US: u32 = 5;
/// A lag without a new minimum for this long is a loss. A loss of 13 is reported after this wait
/// within the 200 ms after which the stream counts as silent.
const DECISION_MS: u32 = 50;
/// A pause that may be a stall with a burst behind it: longer than jitter makes, and shorter than the
/// decision takes, so that no burst goes unnoticed.
const STALL_MS: u32 = 45;
const _: () = assert!(STALL_MS * 1000 > LATE_US + PERIOD_US - 1 && STALL_MS < DECISION_MS);
/// Least distance of a new minimum below the last one: less may be jitter of a constant lag.
const NEW_MINIMUM_US: u32 = 5_000;
/// Most notifications held: a stall of 200 ms, after which the stream counts as silent anyway, and
/// four more.
const MAX_HELD: usize = 24;
/// Longest pause that is measured: longer ones change no decision, and sums stay within u32.
const MAX_PAUSE_MS: u32 = 60_000;

const _: () = assert!(LATE_US < CYCLE_US);
/// Largest lag, so that no sum of it overflows.
const MAX_LAG_US: u32 = MAX_PAUSE_MS * 1000;
const _: () = assert!(MAX_LAG_US.checked_mul(3).is_some());

/// Part of a stream.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Ordered {
    /// Two samples that follow the ones before.
    Pair(Pair),
    /// Missing samples, at least one.
    Gap { missing: u32 },
}

/// The arrival times of one stream.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct ArrivalTiming {
    /// Arrival of the newest notification; none before the first.
    newest: Option<Millis>,
    /// Lag of the arrival, in microseconds.
    lag: u32,
    /// Empty unless `late`.
    held: Vec<Placed, MAX_HELD>,
    late: Option<Late>,
}

/// Notifications arrive late, and the cause is not decided.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Late {
    /// Minimum of the lag since, in microseconds.
    minimum: u32,
    /// Time at which a burst may last have been under way: a new minimum, or after a pause.
    since: Millis,
}

impl ArrivalTiming {
    pub(super) const fn new() -> Self {
        Self {
            newest: None,
            lag: 0,
            held: Vec::new(),
            late: None,
        }
    }

    /// Takes the next notification. Delivers what is certainly in order, and returns how many
    /// notifications were discarded.
    pub(super) fn push(&mut self, placed: Placed, out: &mut impl FnMut(Ordered)) -> u32 {
        let pause = self.measure(placed);
        if self.lag < LATE_US {
            self.late = None;
            for held in core::mem::take(&mut self.held) {
                deliver(held, out);
            }
            deliver(placed, out);
            return 0;
        }
        let (at, lag) = (placed.at, self.lag);
        let late = self.late.get_or_insert(Late {
            minimum: lag,
            since: at,
        });
        if lag + NEW_MINIMUM_US <= late.minimum || pause >= STALL_MS {
            late.since = at;
        }
        late.minimum = late.minimum.min(lag);
        let Late { minimum, since } = *late;
        // Never full here: it is emptied below as soon as it is.
        let held = self.held.push(placed);
        if at.elapsed_since(since) >= DECISION_MS {
            // Whole cycles, rounded down but for the tolerance: the rest is delay, never negative.
            let cycles = (minimum + CYCLE_US - LATE_US) / CYCLE_US;
            // No notification may be earlier than due.
            self.lag -= minimum.min(cycles * CYCLE_US);
            self.late = None;
            self.discard(cycles * u32::from(LANES), out)
        } else if held.is_err() || self.held.is_full() {
            self.discard(0, out)
        } else {
            0
        }
    }

    /// Updates the lag; returns the milliseconds since the notification before.
    fn measure(&mut self, placed: Placed) -> u32 {
        let Some(before) = self.newest.replace(placed.at) else {
            return 0;
        };
        let pause = placed.at.elapsed_since(before).min(MAX_PAUSE_MS);
        let due = PERIOD_US * (1 + placed.missing);
        let lag = self.lag + pause * (1000 - DRIFT_US);
        self.lag = lag.saturating_sub(due).min(MAX_LAG_US);
        pause
    }

    /// Reports all held notifications as missing, with those lost before or among them.
    fn discard(&mut self, unseen: u32, out: &mut impl FnMut(Ordered)) -> u32 {
        let held = self.held.len() as u32;
        let seen: u32 = self.held.iter().map(|placed| placed.missing).sum();
        self.held.clear();
        report_missing(unseen + seen + held, out);
        held
    }
}

fn deliver(placed: Placed, out: &mut impl FnMut(Ordered)) {
    report_missing(placed.missing, out);
    out(Ordered::Pair(placed.pair));
}

fn report_missing(notifications: u32, out: &mut impl FnMut(Ordered)) {
    if notifications > 0 {
        let missing = notifications * PAIR_SAMPLES;
        out(Ordered::Gap { missing });
    }
}
