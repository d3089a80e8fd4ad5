//! Streams of which the truth is known: numbered packets that are lost, doubled, swapped, delayed.
//!
//! The generator is held back only where lanes and times do not contain the answer:
//!
//! * the first packets come quietly: before a quick one has set the pace, a loss of four is unseen;
//! * one packet in five comes without delay, so the pace stays known to a millisecond or two;
//! * jitter stays below what a loss of four makes, and so does the stream's deviation from 100/s;
//! * what a stall held back comes at once when it ends, not in trickles with pauses between;
//! * packets keep their order but for swaps, and the two places before and behind a swap hold no
//!   loss and no other swap: `p + 2` and then `p + 1` after a lost `p` are the lanes of a loss of
//!   two and another of two;
//! * duplicates come right behind.

use super::tests::{Out, arrival, out};
use super::*;
use alloc::vec::Vec;
use proptest::prelude::*;

/// What befalls the stream next.
#[derive(Clone, Copy, Debug)]
enum Mischief {
    /// So many packets come.
    Quiet(u32),
    /// So many are lost.
    Lose(u32),
    /// The next one comes twice.
    Double,
    /// The next two swap places.
    Swap,
    /// The radio holds everything back for so many milliseconds.
    Stall(u32),
}
use Mischief::{Double, Lose, Quiet, Stall, Swap};

/// Every so many packets one comes without delay.
const QUICK: u32 = 5;
/// Packets that set the pace.
const LEAD: u32 = 20;

fn mischief() -> impl Strategy<Value = Mischief> {
    prop_oneof![
        2 => (1..4u32).prop_map(Quiet),
        2 => (4..60u32).prop_map(Quiet),
        3 => (1..=13u32).prop_map(Lose),
        1 => Just(Double),
        1 => Just(Swap),
        1 => (10..=260u32).prop_map(Stall),
    ]
}

/// Mischief that loses nothing. A stall of more than 200 ms is silence, and may be told as a loss:
/// so are two that join, and quiet keeps them apart.
fn harmless() -> impl Strategy<Value = Vec<Mischief>> {
    prop_oneof![
        3 => (1..60u32).prop_map(|count| Vec::from([Quiet(count)])),
        1 => Just(Vec::from([Double])),
        1 => Just(Vec::from([Swap])),
        1 => (10..=200u32).prop_map(|milliseconds| Vec::from([Stall(milliseconds), Quiet(30)])),
    ]
}

/// What came of a stream.
struct Lived {
    outs: Vec<Out>,
    counters: Counters,
    /// The number of the last packet that was sent and not lost.
    last: u32,
}

/// Plays the stream into a sequence: packet `n` leaves at 10 n ms, stretched by `drift`, and comes
/// when `jitter` and the stalls let it, never before the one before it.
fn live(script: &[Mischief], jitter: &[u32], drift_per_mille: i32) -> Lived {
    let mut sent = Vec::new(); // (number, copies), in the order of arrival
    let mut stalls = Vec::new(); // (number at which it begins, milliseconds)
    let mut number = 0;
    let quiet = |count: u32, number: &mut u32, sent: &mut Vec<(u32, u32)>| {
        sent.extend((*number..*number + count).map(|number| (number, 1)));
        *number += count;
    };
    quiet(LEAD, &mut number, &mut sent);
    for one in script {
        match *one {
            Quiet(count) => quiet(count, &mut number, &mut sent),
            Lose(count) => number += count,
            Double => {
                sent.push((number, 2));
                number += 1;
            }
            Swap => {
                quiet(2, &mut number, &mut sent);
                sent.extend([(number + 1, 1), (number, 1)]);
                number += 2;
                quiet(2, &mut number, &mut sent);
            }
            Stall(milliseconds) => stalls.push((number, milliseconds)),
        }
    }
    // Enough in time for every question to be settled.
    quiet(80, &mut number, &mut sent);

    let period_us = 10_000u32.saturating_add_signed(10 * drift_per_mille);
    let leaves = |number: u32| number * period_us / 1000;
    let mut free = 0;
    let mut newest = 0;
    let (mut sequence, mut counters) = (Sequence::new(), Counters::default());
    let mut outs = Vec::new();
    for (number, copies) in sent {
        newest = newest.max(number);
        // Nor does a packet before the quick one delay that.
        let delay = match (number % QUICK, jitter) {
            (0, _) | (_, []) => 0,
            (since, jitter) => jitter[number as usize % jitter.len()].min(9 * (QUICK - since)),
        };
        let mut at = free.max(leaves(newest) + delay);
        // In order of their beginning, so that stalls that join are one.
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
    Lived {
        outs,
        counters,
        last,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn nothing_comes_twice_and_no_loss_is_passed_over(
        script in prop::collection::vec(mischief(), 0..40),
        jitter in prop::collection::vec(0..=30u32, 0..50),
        drift in -3..=3i32,
    ) {
        let Lived { outs, counters, last } = live(&script, &jitter, drift);
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
        // At the end all has been quiet for 0.8 s: at most a few late ones still wait.
        prop_assert!(previous.is_some_and(|previous| last - previous < 10));
        prop_assert_eq!(counters.lost, missing);
    }

    #[test]
    fn nothing_lost_is_nothing_told(
        script in prop::collection::vec(harmless(), 0..40).prop_map(|script| script.concat()),
        jitter in prop::collection::vec(0..=30u32, 0..50),
        drift in -3..=3i32,
    ) {
        let Lived { outs, counters, last } = live(&script, &jitter, drift);
        prop_assert!(outs.into_iter().eq((0..=last).map(Out::Packet)));
        let doubles = script.iter().filter(|one| matches!(one, Double)).count();
        let swaps = script.iter().filter(|one| matches!(one, Swap)).count();
        prop_assert_eq!(counters.duplicates, doubles as u32);
        prop_assert_eq!(counters.reordered, swaps as u32);
        prop_assert_eq!(counters.given_up, 0);
    }

    #[test]
    fn lone_losses_are_counted_exactly(
        losses in prop::collection::vec((1..=3u32, 10..30u32), 1..10),
        jitter in prop::collection::vec(0..=30u32, 0..50),
    ) {
        let script: Vec<_> = losses.iter().flat_map(|(lost, quiet)| [Lose(*lost), Quiet(*quiet)]).collect();
        let Lived { outs, counters, .. } = live(&script, &jitter, 0);
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
    ) {
        let script: Vec<_> = losses.iter().flat_map(|(lost, quiet)| [Lose(*lost), Quiet(*quiet)]).collect();
        let Lived { outs, last, .. } = live(&script, &jitter, 0);
        let samples: u32 = outs.into_iter().map(|one| match one {
            Out::Gap(samples) => samples,
            Out::Packet(_) => 2,
        }).sum();
        prop_assert_eq!(samples, 2 * (last + 1));
    }
}
