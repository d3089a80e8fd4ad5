//! The composed line over a model that is easy to foretell.

use super::*;
use crate::model::LookBackLogits;
use crate::stream::preprocess::clean;
use crate::stream::safe_state::Cause;
use crate::units::{CHANNELS, PATCH, Patch};
use alloc::{boxed::Box, vec, vec::Vec};
use proptest::prelude::*;

/// Says of each patch, whenever asked, the class that the patch's channel 0 spells out. Stricter
/// than a model: it minds that patches are whole and never more than the stream gave.
struct Spelled;

impl Encode for Spelled {
    type State = Vec<usize>;

    fn classes(&self) -> usize {
        3
    }

    fn fresh(&self) -> Self::State {
        Vec::new()
    }

    fn reset(&self, state: &mut Self::State) {
        state.clear();
    }

    fn step(&self, state: &mut Self::State, patch: &Patch) -> LookBackLogits {
        let sum: usize = patch.iter().map(|sample| usize::from(sample[0])).sum();
        state.push(sum % 3);
        let mut rows = [[0.0; MAX_CLASSES]; LOOK_BACK];
        for (row, class) in rows.iter_mut().zip(state.iter().rev()) {
            row[*class] = 1.0;
            row[5] = 100.0; // no class of this model
        }
        rows
    }
}

fn pipeline() -> Pipeline<'static, Spelled> {
    let state = Box::leak(Box::new(Spelled.fresh()));
    Pipeline::new(Spelled, state, Settings::PAPER_IN_PATCHES, Start::Boot).unwrap()
}

/// Ten of these spell class `value`.
fn spelling(value: i8) -> Sample {
    [value; CHANNELS]
}

/// When sample `index` comes.
fn at(index: u32) -> Millis {
    Millis(index * 5)
}

fn feed(pipeline: &mut Pipeline<'_, Spelled>, from: u32, count: u32, value: i8) -> Vec<Report> {
    (from..from + count)
        .flat_map(|index| pipeline.sample(at(index), spelling(value)))
        .collect()
}

/// Kind, instant, emitted, status: what the tests foretell of a report.
type Line = (Kind, u32, u32, Status);

fn lines(reports: impl IntoIterator<Item = Report>) -> Vec<Line> {
    let line = |report: Report| {
        (
            report.kind,
            report.instant.0,
            report.emitted.0,
            report.status,
        )
    };
    reports.into_iter().map(line).collect()
}

const OPEN: Status = Status::Valid(Intent::Open);

/// Window 0 ends at sample 599; the look-ahead is 5 patches and labels come at every second
/// window, so the first is due at window 6. One sample more for the median.
const FIRST_VALID: [Line; 2] = [(Kind::State, 609, 660, OPEN), (Kind::Label, 609, 660, OPEN)];

#[test]
fn labels_begin_after_600_samples_the_look_ahead_and_the_median() {
    let mut pipeline = pipeline();
    let boot = pipeline.state_report();
    assert_eq!(
        lines([boot]),
        [(Kind::State, 0, 0, Status::Safe(Cause::Boot))]
    );
    assert_eq!(lines(feed(&mut pipeline, 0, 660, 1)), []);
    assert_eq!(lines(feed(&mut pipeline, 660, 1, 1)), FIRST_VALID);
    let next = feed(&mut pipeline, 661, 40, 1);
    assert_eq!(
        lines(next.iter().copied()),
        [(Kind::Label, 629, 680, OPEN), (Kind::Label, 649, 700, OPEN)]
    );
    assert_eq!(next[1].sequence, boot.sequence + 4);
    assert_eq!(pipeline.counters(), Counters::default());
}

#[test]
fn five_lost_samples_are_bridged_by_the_last_one() {
    let mut pipeline = pipeline();
    assert_eq!(lines(feed(&mut pipeline, 0, 650, 1)), []);
    assert_eq!(lines(pipeline.gap(at(655), 5)), []);
    let reports = feed(&mut pipeline, 655, 6, 1);
    assert_eq!(lines(reports.iter().copied()), FIRST_VALID);
    let expected = Counters {
        lost: 5,
        bridged: 5,
        resets: 0,
    };
    assert_eq!(reports[1].counters, expected);
}

#[test]
fn a_label_can_fall_due_on_a_bridged_sample() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 658, 1);
    assert_eq!(lines(pipeline.gap(at(663), 5)), FIRST_VALID);
}

#[test]
fn six_lost_samples_reset_the_window() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let safe = Status::Safe(Cause::Gap);
    assert_eq!(
        lines(pipeline.gap(at(667), 6)),
        [(Kind::State, 666, 666, safe)]
    );
    let expected = Counters {
        lost: 6,
        bridged: 0,
        resets: 1,
    };
    assert_eq!(pipeline.counters(), expected);
    assert_eq!(
        *pipeline.state,
        Spelled.fresh(),
        "the model still remembers"
    );
    // A second gap before any sample has nothing to give up.
    assert_eq!(lines(pipeline.gap(at(668), 1)), []);
    assert_eq!(pipeline.counters().resets, 1);

    // The window begins again at sample 668.
    assert_eq!(lines(feed(&mut pipeline, 668, 660, 1)), []);
    assert_eq!(
        lines(feed(&mut pipeline, 668 + 660, 1, 1)),
        [
            (Kind::State, 668 + 609, 668 + 660, OPEN),
            (Kind::Label, 668 + 609, 668 + 660, OPEN)
        ]
    );
}

#[test]
fn silence_and_disconnection_give_up_the_window() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    assert_eq!(pipeline.deadline(), Some(Millis(3500)));
    assert_eq!(lines(pipeline.tick(Millis(3499))), []);
    let silent = Status::Safe(Cause::Silence);
    assert_eq!(
        lines(pipeline.tick(Millis(3500))),
        [(Kind::State, 660, 660, silent)]
    );
    assert_eq!(pipeline.status(), silent);
    assert_eq!(
        *pipeline.state,
        Spelled.fresh(),
        "the model still remembers"
    );
    let gone = Status::Safe(Cause::Disconnected);
    assert_eq!(
        lines(pipeline.disconnected(Millis(4000))),
        [(Kind::State, 660, 660, gone)]
    );
    assert_eq!(pipeline.counters().resets, 1);
    assert_eq!(pipeline.deadline(), None);
    assert_eq!(lines(feed(&mut pipeline, 661, 660, 1)), []);
}

#[test]
fn a_sample_after_a_silence_reports_it_without_a_tick() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let reports = pipeline.sample(Millis(3600), spelling(1));
    let silent = Status::Safe(Cause::Silence);
    assert_eq!(lines(reports), [(Kind::State, 660, 660, silent)]);
    assert_eq!(pipeline.ring.contiguous(), 0);
}

#[test]
fn a_model_of_too_many_classes_is_refused() {
    struct Seven;
    impl Encode for Seven {
        type State = ();
        fn classes(&self) -> usize {
            7
        }
        fn fresh(&self) {}
        fn reset(&self, (): &mut ()) {}
        fn step(&self, (): &mut (), _: &Patch) -> LookBackLogits {
            [[0.0; MAX_CLASSES]; LOOK_BACK]
        }
    }
    let refused = Pipeline::new(Seven, &mut (), Settings::PAPER_IN_PATCHES, Start::Boot).err();
    assert_eq!(refused, Some(SettingsError::Classes { most: 6, found: 7 }));
}

/// The labels of an unbroken recording, step by step over the whole of it.
fn by_hand(recording: &[Sample]) -> Vec<(u32, Intent)> {
    // The last clean sample needs a sample that has not come.
    let mut samples: Vec<_> = clean(recording.iter().copied()).collect();
    samples.pop();
    let spelled: Vec<usize> = samples
        .as_chunks::<PATCH>()
        .0
        .iter()
        .map(|patch| patch.iter().map(|sample| usize::from(sample[0])).sum())
        .collect();
    let mut labels = vec![];
    // The window that ends with patch 59 is the first; all rows of windows p ... p + 5.
    for end in (65..spelled.len()).step_by(2) {
        let mut votes = [0; 3];
        for window in end - 5..=end {
            for patch in end - 5..=window {
                votes[spelled[patch] % 3] += 1;
            }
        }
        let most = votes.iter().max();
        let class = votes.iter().position(|count| Some(count) == most);
        let instant = (end as u32 - 5) * 10 + 9;
        labels.extend(
            class
                .and_then(Intent::from_class)
                .map(|intent| (instant, intent)),
        );
    }
    labels
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn the_line_does_what_its_rooms_do_one_after_another(
        recording in prop::collection::vec(any::<Sample>(), 600..1200),
    ) {
        let mut pipeline = pipeline();
        let labels: Vec<_> = (0..)
            .zip(&recording)
            .flat_map(|(index, sample)| pipeline.sample(at(index), *sample))
            .filter(|report| report.kind == Kind::Label)
            .map(|report| (report.instant.0, report.status.label()))
            .collect();
        // Windows 6, 8, ...: the first label falls to the first even window past the look-ahead.
        let expected: Vec<_> = by_hand(&recording).into_iter().collect();
        prop_assert_eq!(labels, expected);
    }
}
