//! Impaired streams with known content: numbered notifications that are lost, duplicated, swapped,
//! delayed.
//!
//! The generator is restricted only where lanes and arrival times do not determine the answer:
//!
//! * the first notifications are unimpaired: before one without delay has set the due times, a loss of
//!   four is not detectable;
//! * one notification in five has no delay, so the due times are known to a millisecond or two;
//! * jitter stays below the delay of a loss of four, and so does the stream's deviation from 100/s;
//! * what a stall delays arrives in one burst at its end, not in several with pauses between;
//! * only swaps change the order, and the two positions before and after a swap have no loss and no
//!   other swap: `p + 2` and then `p + 1` after a lost `p` are the lanes of a loss of two and another
//!   of two;
//! * duplicates follow immediately.

use super::tests::{Out, arrival, out};
use super::*;
use alloc::vec::Vec;
use proptest::prelude::*;

/// The next section of a stream.
#[derive(Clone, Copy, Debug)]
enum Impairment {
    /// A number of notifications without impairment.
    Clean(u32),
    /// A number of lost notifications.
    Lose(u32),
    /// The next one is duplicated.
    Duplicate,
    /// The next two are swapped.
    Swap,
    /// The radio delays everything for these milliseconds.
    Stall(u32),
}
use Impairment::{Clean, Duplicate, Lose, Stall, Swap};

/// Notifications from one without delay to the next.
const PROMPT_EVERY: u32 = 5;
/// Notifications that set the due times.
const LEAD: u32 = 20;

fn impairment() -> impl Strategy<Value = Impairment> {
    prop_oneof![
        2 => (1..4u32).prop_map(Clean),
        2 => (4..60u32).prop_map(Clean),
        3 => (1..=13u32).prop_map(Lose),
        1 => Just(Duplicate),
        1 => Just(Swap),
        1 => (10..=260u32).prop_map(Stall),
    ]
}

/// Impairments without loss. A stall of more than 200 ms is silence, and may be reported as a loss; so
/// may two stalls without a pause between.
fn harmless() -> impl Strategy<Value = Vec<Impairment>> {
    prop_oneof![
        3 => (1..60u32).prop_map(|count| Vec::from([Clean(count)])),
        1 => Just(Vec::from([Duplicate])),
        1 => Just(Vec::from([Swap])),
        1 => (10..=200u32).prop_map(|milliseconds| Vec::from([Stall(milliseconds), Clean(30)])),
    ]
}

/// Result of a simulated stream.
struct Simulated {
    outs: Vec<Out>,
    counters: Counters,
    /// The number of the last notification that was not lost.
    last: u32,
}

/// Pushes the stream into a sequence: notification `n` is sent at 10 n ms, stretched by `drift`, and
/// arrives after `jitter` and stalls, never before the one before it.
fn simulate(script: &[Impairment], jitter: &[u32], drift_per_mille: i32) -> Simulated {
    let mut sent = Vec::new(); // (number, copies), in the order of arrival
    let mut stalls = Vec::new(); // (number at which it begins, milliseconds)
    let mut number = 0;
    let clean = |count: u32, number: &mut u32, sent: &mut Vec<(u32, u32)>| {
        sent.extend((*number..*number + count).map(|number| (number, 1)));
        *number += count;
    };
    clean(LEAD, &mut number, &mut sent);
    for one in script {
        match *one {
            Clean(count) => clean(count, &mut number, &mut sent),
            Lose(count) => number += count,
            Duplicate => {
                sent.push((number, 2));
                number += 1;
            }
            Swap => {
                clean(2, &mut number, &mut sent);
                sent.extend([(number + 1, 1), (number, 1)]);
                number += 2;
                clean(2, &mut number, &mut sent);
            }
            Stall(milliseconds) => stalls.push((number, milliseconds)),
        }
    }
    // Enough in time to decide everything.
    clean(80, &mut number, &mut sent);

    let period_us = 10_000u32.saturating_add_signed(10 * drift_per_mille);
    let leaves = |number: u32| number * period_us / 1000;
    let mut free = 0;
    let mut newest = 0;
    let (mut sequence, mut counters) = (Sequence::new(), Counters::default());
    let mut outs = Vec::new();
    for (number, copies) in sent {
        newest = newest.max(number);
        // Nor does the jitter of an earlier one delay the one without delay.
        let delay = match (number % PROMPT_EVERY, jitter) {
            (0, _) | (_, []) => 0,
            (since, jitter) => {
                jitter[number as usize % jitter.len()].min(9 * (PROMPT_EVERY - since))
            }
        };
        let mut at = free.max(leaves(newest) + delay);
        // In order of their beginning, so that adjoining stalls become one.
        for (begin, milliseconds) in &stalls {
            let stall = leaves(*begin)..leaves(*begin) + milliseconds;
            if stall.contains(&at) {
                at = stall.end;
            }
        }
        free = at;
        for _ in 0..copies {
            sequence.push(arrival(at, number), &mut counters, &mut |one| {
                outs.push(out(one))
            });
        }
    }
    let last = number - 1;
    Simulated {
        outs,
        counters,
        last,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn nothing_is_delivered_twice_and_no_loss_is_ignored(
        script in prop::collection::vec(impairment(), 0..40),
        jitter in prop::collection::vec(0..=30u32, 0..50),
        drift in -3..=3i32,
    ) {
        let Simulated { outs, counters, last } = simulate(&script, &jitter, drift);
        let (mut previous, mut gap, mut missing) = (None, false, 0);
        for one in &outs {
            match *one {
                Out::Gap(samples) => {
                    prop_assert!(samples > 0);
                    missing += samples;
                    gap = true;
                }
                Out::Packet(number) => {
                    if let Some(previous) = previous {
                        prop_assert!(number > previous, "{previous}, then {number}");
                        prop_assert!(gap || number == previous + 1, "{previous}, then {number}");
                    }
                    (previous, gap) = (Some(number), false);
                }
            }
        }
        // The end is clean for 0.8 s: at most a few late ones are still held.
        prop_assert!(previous.is_some_and(|previous| last - previous < 10));
        prop_assert_eq!(counters.lost, missing);
    }

    #[test]
    fn without_loss_there_is_no_gap(
        script in prop::collection::vec(harmless(), 0..40).prop_map(|script| script.concat()),
        jitter in prop::collection::vec(0..=30u32, 0..50),
        drift in -3..=3i32,
    ) {
        let Simulated { outs, counters, last } = simulate(&script, &jitter, drift);
        prop_assert!(outs.into_iter().eq((0..=last).map(Out::Packet)));
        let duplicates = script.iter().filter(|one| matches!(one, Duplicate)).count();
        let swaps = script.iter().filter(|one| matches!(one, Swap)).count();
        prop_assert_eq!(counters.duplicates, duplicates as u32);
        prop_assert_eq!(counters.reordered, swaps as u32);
        prop_assert_eq!(counters.given_up, 0);
    }

    #[test]
    fn lone_losses_are_counted_exactly(
        losses in prop::collection::vec((1..=3u32, 10..30u32), 1..10),
        jitter in prop::collection::vec(0..=30u32, 0..50),
    ) {
        let script: Vec<_> = losses.iter().flat_map(|(lost, clean)| [Lose(*lost), Clean(*clean)]).collect();
        let Simulated { outs, counters, .. } = simulate(&script, &jitter, 0);
        let gaps = outs.into_iter().filter_map(|one| match one {
            Out::Gap(samples) => Some(samples),
            Out::Packet(_) => None,
        });
        prop_assert!(gaps.eq(losses.iter().map(|(lost, _)| 2 * lost)));
        prop_assert_eq!(counters.given_up, 0);
    }

    #[test]
    fn positions_are_right_again_after_lone_losses_of_any_length(
        losses in prop::collection::vec((1..=13u32, 30..40u32), 1..10),
        jitter in prop::collection::vec(0..=15u32, 0..50),
        drift in -1..=1i32,
    ) {
        let script: Vec<_> = losses.iter().flat_map(|(lost, clean)| [Lose(*lost), Clean(*clean)]).collect();
        let Simulated { outs, last, .. } = simulate(&script, &jitter, drift);
        let samples: u32 = outs.into_iter().map(|one| match one {
            Out::Gap(samples) => samples,
            Out::Packet(_) => 2,
        }).sum();
        prop_assert_eq!(samples, 2 * (last + 1));
    }
}
