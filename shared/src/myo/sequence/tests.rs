//! The sequence as tables: arrivals with their times, and the expected output.

use super::*;
use crate::myo::Lane;
use crate::myo::arrival_timing::Ordered;
use crate::units::Millis;
use alloc::vec::Vec;

/// Output: the number of a notification, or how many samples are missing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Out {
    Packet(u32),
    Gap(u32),
}
use Out::{Gap, Packet};

/// Notification `number`, whose samples encode its number.
pub(super) fn arrival(at: u32, number: u32) -> Arrival {
    let [a, b, c, d] = number.to_le_bytes().map(u8::cast_signed);
    Arrival {
        at: Millis(at),
        lane: Lane::new((number % 4) as u8).unwrap(),
        pair: [[a, b, c, d, 0, 0, 0, 0], [0; 8]],
    }
}

pub(super) fn out(ordered: Ordered) -> Out {
    match ordered {
        Ordered::Pair([[a, b, c, d, ..], _]) => {
            Packet(u32::from_le_bytes([a, b, c, d].map(i8::cast_unsigned)))
        }
        Ordered::Gap { missing } => Gap(missing),
    }
}

/// Pushes (time, number) and returns the output of each notification.
fn run(arrivals: &[(u32, u32)]) -> (Vec<Vec<Out>>, Counters) {
    let (mut sequence, mut counters) = (Sequence::new(), Counters::default());
    let outs = arrivals.iter().map(|(at, number)| {
        let mut outs = Vec::new();
        sequence.push(arrival(*at, *number), &mut counters, &mut |ordered| {
            outs.push(out(ordered));
        });
        outs
    });
    (outs.collect(), counters)
}

/// Pushes each number at its due time, after ten more that set the due times; returns the output of
/// all but those ten.
fn in_time(numbers: impl IntoIterator<Item = u32>) -> (Vec<Vec<Out>>, Counters) {
    let due = |number| (100 + 10 * number, 10 + number);
    let mut arrivals: Vec<_> = (0..10).map(|number| (10 * number, number)).collect();
    arrivals.extend(numbers.into_iter().map(due));
    let (mut outs, counters) = run(&arrivals);
    (outs.split_off(10), counters)
}

fn packet(number: u32) -> Out {
    Packet(10 + number)
}

#[test]
fn a_loss_of_four_to_thirteen_is_reported_within_200_ms() {
    for lost in 4..=13 {
        let after = 1 + lost;
        let (outs, counters) = in_time((0..1).chain(after..after + 20));
        let (silent, reported): (Vec<_>, Vec<_>) =
            outs[1..].iter().partition(|outs| outs.is_empty());
        // The first one after the loss is due after `after` periods: reported before 200 ms of silence.
        assert!(
            (after + silent.len() as u32) * 10 < 200,
            "{lost}: {silent:?}"
        );
        // The held ones are discarded with the lost ones, and nothing else.
        let [Gap(missing), ..] = reported[0][..] else {
            panic!("{lost}: {reported:?}");
        };
        assert_eq!(missing, 2 * lost + counters.given_up, "loss of {lost}");
        assert_eq!(counters.lost, missing);
        // From then on everything is delivered, the next one first.
        let resumed = reported.iter().flat_map(|outs| outs.iter().copied());
        let first = 1 + missing / 2;
        let expected = [Gap(missing)]
            .into_iter()
            .chain((first..after + 20).map(packet));
        assert!(resumed.eq(expected), "{lost}: {reported:?}");
    }
}

#[test]
fn a_stall_too_long_to_hold_is_a_loss_and_later_losses_are_still_detected() {
    // 400 ms of stall, then a burst of forty in which four are missing.
    let mut arrivals: Vec<_> = (0..=10).map(|n| (10 * n, n)).collect();
    arrivals.extend((11..=40).chain(45..=50).map(|n| (510, n)));
    arrivals.extend((51..80).map(|n| (10 * n, n)));
    let (outs, _) = run(&arrivals);
    let outs: Vec<_> = outs.into_iter().flatten().collect();
    let mut previous = 10;
    let mut gap = false;
    for one in &outs[11..] {
        match one {
            Gap(_) => gap = true,
            Packet(number) => {
                assert!(
                    *number == previous + 1 || gap,
                    "{previous}, {number}: {outs:?}"
                );
                (previous, gap) = (*number, false);
            }
        }
    }
    assert_eq!(previous, 79);
}

#[test]
fn a_loss_that_looks_like_a_swap_is_detected_by_time() {
    // 1, 3, 4 and 6 are lost: the lanes of 0, 2, 5, 7 are those of a swap.
    let (outs, counters) = in_time([0, 2, 5].into_iter().chain(7..40));
    let outs: Vec<_> = outs.into_iter().flatten().collect();
    assert_eq!(counters.reordered, 1); // by the lanes alone
    let [first, Gap(missing), Packet(next), ..] = outs[..] else {
        panic!("{outs:?}");
    };
    assert_eq!((first, missing), (packet(0), 2 * (next - 11)));
}

#[test]
fn a_duplicate_is_dropped_and_a_repeated_lane_is_not() {
    let (outs, counters) = run(&[(0, 0), (10, 1), (10, 1), (29, 1), (31, 2)]);
    assert_eq!(outs.concat(), [0, 1, 2].map(Packet));
    assert_eq!((counters.duplicates, counters.lost), (2, 0));
    // Other bytes in the same lane: a loss of three, at any time.
    let (outs, _) = run(&[(0, 0), (10, 1), (11, 5)]);
    assert_eq!(outs.concat(), [Packet(0), Packet(1), Gap(6), Packet(5)]);
}

#[test]
fn the_same_bytes_in_a_repeated_lane_40_ms_later_are_a_loss() {
    let (mut sequence, mut counters) = (Sequence::new(), Counters::default());
    let mut outs = Vec::new();
    let flat = [[0; 8]; 2]; // the armband is not worn
    for (at, lane) in [(0, 0), (10, 1), (50, 1), (60, 2)] {
        let (at, lane) = (Millis(at), Lane::new(lane).unwrap());
        let pair = flat;
        sequence.push(Arrival { at, lane, pair }, &mut counters, &mut |one| {
            outs.push(one)
        });
    }
    let pair = Ordered::Pair(flat);
    assert_eq!(outs, [pair, pair, Ordered::Gap { missing: 6 }, pair, pair]);
}

#[test]
fn a_faster_stream_has_no_gaps() {
    for per_packet_us in [500u32, 1_000, 2_000, 5_000, 9_900, 10_000, 10_049] {
        let arrivals: Vec<_> = (0..30_000).map(|n| (n * per_packet_us / 1000, n)).collect();
        let (outs, counters) = run(&arrivals);
        assert!(
            outs.iter().all(|outs| outs.len() == 1),
            "{per_packet_us} us"
        );
        assert_eq!(counters, Counters::default(), "{per_packet_us} us");
    }
}

#[test]
fn stalls_and_the_wrap_of_the_clock_lose_nothing() {
    // Times of notifications. 11 arrives at 200 ms, the others that are due then at 260 ms.
    let single_in_a_stall = |n| match n {
        0..=10 => 10 * n,
        11 => 200,
        _ => (10 * n).max(260),
    };
    let faster_with_a_stall = |n| if n > 50 { 160 + n } else { n };
    let wrapping = |n| (u32::MAX - 95).wrapping_add(10 * n);
    let times: [&dyn Fn(u32) -> u32; 3] = [&single_in_a_stall, &faster_with_a_stall, &wrapping];
    for (row, at) in times.iter().enumerate() {
        let arrivals: Vec<_> = (0..200).map(|n| (at(n), n)).collect();
        let (outs, counters) = run(&arrivals);
        assert!(outs.into_iter().flatten().eq((0..200).map(Packet)), "{row}");
        assert_eq!(counters, Counters::default(), "{row}");
    }
    let (outs, _) = run(&[(100, 0), (90, 1), (80, 2)]);
    assert_eq!(outs.concat(), [0, 1, 2].map(Packet), "backwards");
}
