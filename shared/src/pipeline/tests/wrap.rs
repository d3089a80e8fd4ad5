//! Positions, line numbers and counters at the ends of their ranges.

use super::*;
use crate::stream::alignment::Arm;
use crate::uart_line::alignment::AlignmentState;

/// A pipeline whose next sample has this position.
fn pipeline_at(next: u32) -> Pipeline<'static, SumModel> {
    let mut pipeline = pipeline();
    pipeline.gap(Millis(0), next);
    pipeline
}

#[test]
fn before_the_first_sample_the_newest_is_0() {
    let mut pipeline = pipeline();
    assert_eq!(pipeline.state_report().emitted, SampleIndex(0));
    pipeline.begin_alignment(Arm::Unknown);
    let report = pipeline.take_alignment_report().unwrap();
    assert_eq!(report.state, AlignmentState::Unavailable);
    assert_eq!(report.emitted, SampleIndex(0));
    // Nor does a gap of 0 samples change it.
    pipeline.gap(Millis(0), 0);
    assert_eq!(pipeline.state_report().emitted, SampleIndex(0));
}

#[test]
fn the_sample_before_position_0_is_the_largest_one() {
    let mut pipeline = pipeline_at(u32::MAX - 9);
    assert_eq!(pipeline.state_report().emitted, SampleIndex(u32::MAX - 10));
    // Ten samples: the next one has position 0.
    assert_eq!(fields(feed(&mut pipeline, 0, 10, 1)), []);
    let state = pipeline.state_report();
    let newest = SampleIndex(u32::MAX);
    assert_eq!((state.instant, state.emitted), (newest, newest));
    pipeline.begin_alignment(Arm::Unknown);
    let report = pipeline.take_alignment_report().unwrap();
    assert_eq!(report.emitted, newest);
    let reports = pipeline.tick(Millis(500));
    assert_eq!(fields(reports), [safe(u32::MAX, Cause::Silence)]);
}

#[test]
fn lost_samples_up_to_the_wrap_count_as_the_newest() {
    let mut pipeline = pipeline_at(u32::MAX - 9);
    feed(&mut pipeline, 0, 4, 1);
    let reports = pipeline.gap(at(10), 6);
    assert_eq!(fields(reports), [safe(u32::MAX, Cause::Gap)]);
    let mut pipeline = pipeline_at(u32::MAX);
    pipeline.gap(at(0), 1);
    assert_eq!(pipeline.state_report().emitted, SampleIndex(u32::MAX));
}

#[test]
fn labels_across_the_wrap_are_those_of_any_other_position() {
    let first = u32::MAX - 699;
    let [mut early, mut late] = [0, first].map(pipeline_at);
    let mut labels = 0;
    for index in 0..2000 {
        if index == 690 {
            for pipeline in [&mut early, &mut late] {
                let reports = pipeline.gap(at(index), 5);
                assert_eq!(fields(reports), []);
            }
        }
        let (now, sample) = (at(index), constant((index / 30 % 3) as i8));
        let expected = fields(early.sample(now, sample));
        let found = fields(late.sample(now, sample));
        labels += found.len();
        let moved = |(kind, instant, emitted, status): Fields| {
            let moved = |position: u32| position.wrapping_add(first);
            (kind, moved(instant), moved(emitted), status)
        };
        assert_eq!(found, expected.into_iter().map(moved).collect::<Vec<_>>());
    }
    assert!(labels > 60, "{labels}");
}

#[test]
fn line_numbers_wrap() {
    let mut pipeline = pipeline();
    pipeline.output.sequence = u32::MAX;
    pipeline.begin_alignment(Arm::Unknown);
    let last = pipeline.take_alignment_report().unwrap();
    assert_eq!(last.sequence, u32::MAX);
    assert_eq!(pipeline.state_report().sequence, 0);
    assert_eq!(pipeline.state_report().sequence, 1);
}

#[test]
fn counters_stay_at_their_maximum() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 20, 1);
    pipeline.window.counters = counters([u32::MAX - 3, u32::MAX - 3, u32::MAX]);
    pipeline.gap(at(20), 5);
    let most = counters([u32::MAX; 3]);
    assert_eq!(pipeline.window.counters, most);
    pipeline.gap(at(25), u32::MAX);
    assert_eq!(pipeline.window.counters, most);
    let line = alloc::format!("{}", pipeline.state_report());
    assert!(
        line.contains(",4294967295,4294967295,4294967295,0*"),
        "{line}"
    );
}
