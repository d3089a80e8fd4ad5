//! The pipeline with a model whose output is easy to predict.

use super::*;
use crate::intent::MAX_LOGITS;
use crate::model::LookBackLogits;
use crate::stream::preprocess::{Median, Preprocessing, clean};
use crate::uart_line::Counters;
use crate::uart_line::alignment::AlignmentReport;
use crate::units::{CHANNELS, LOOK_BACK, PATCH, Patch};
use alloc::{boxed::Box, vec::Vec};
use proptest::prelude::*;

/// A model that classifies each patch by the sum of its channel 0, modulo 3, in every row that refers
/// to it. Rows for patches that were never pushed have no class.
struct SumModel;

impl Encode for SumModel {
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
        let mut rows = [[0.0; MAX_LOGITS]; LOOK_BACK];
        for (row, class) in rows.iter_mut().zip(state.iter().rev()) {
            row[*class] = 1.0;
            row[5] = 100.0; // no class of this model
        }
        rows
    }
}

/// A label for each patch without a gate, so that no label depends on when the first one was due.
const EACH_PATCH: Settings = Settings {
    hold: 1,
    ..Settings::PAPER_IN_PATCHES
};

fn pipeline_of<E: Encode>(encoder: E, settings: Settings) -> Pipeline<'static, E>
where
    E::State: 'static,
{
    let state = Box::leak(Box::new(encoder.fresh()));
    Pipeline::new(encoder, state, settings).unwrap()
}

fn pipeline() -> Pipeline<'static, SumModel> {
    pipeline_of(SumModel, Settings::PAPER_IN_PATCHES)
}

/// A patch of these has the class `10 value` modulo 3, which is `value`.
fn constant(value: i8) -> Sample {
    [value; CHANNELS]
}

/// Time of sample `index`.
fn at(index: u32) -> Millis {
    Millis(index * 5)
}

fn feed(pipeline: &mut Pipeline<'_, SumModel>, from: u32, count: u32, value: i8) -> Vec<Report> {
    (from..from + count)
        .flat_map(|index| pipeline.sample(at(index), constant(value)))
        .collect()
}

/// Reports of a range of a stream's samples, and of the alignment meanwhile.
fn run<E: Encode>(
    pipeline: &mut Pipeline<'_, E>,
    samples: &[Sample],
    range: core::ops::Range<usize>,
) -> (Vec<Report>, Vec<AlignmentReport>) {
    let mut reports = Vec::new();
    let mut news = Vec::new();
    for index in range {
        reports.extend(pipeline.sample(at(index as u32), samples[index]));
        news.extend(pipeline.take_alignment_report());
    }
    (reports, news)
}

/// Instants from one on, with their labels.
fn labels(reports: impl IntoIterator<Item = Report>, from: u32) -> Vec<(u32, Status)> {
    let labels = reports
        .into_iter()
        .filter(|report| report.kind == ReportKind::Label && report.instant.0 >= from);
    labels
        .map(|report| (report.instant.0, report.status))
        .collect()
}

const fn counters([lost, bridged, resets]: [u32; 3]) -> Counters {
    Counters {
        lost,
        bridged,
        resets,
    }
}

/// The fields of a report that the tests predict: kind, instant, emitted, status.
type Fields = (ReportKind, u32, u32, Status);

fn fields(reports: impl IntoIterator<Item = Report>) -> Vec<Fields> {
    let fields = |report: Report| {
        (
            report.kind,
            report.instant.0,
            report.emitted.0,
            report.status,
        )
    };
    reports.into_iter().map(fields).collect()
}

const OPEN: Status = Status::Valid(Intent::Open);

/// The line that the state becomes safe after the newest sample.
const fn safe(newest: u32, cause: Cause) -> Fields {
    (ReportKind::State, newest, newest, Status::Safe(cause))
}

/// Window 0 ends at sample 599. With a look-ahead of 5 patches and a label at every second window, the
/// first label is due at window 6. The median lags one sample.
const FIRST_VALID: [Fields; 2] = [
    (ReportKind::State, 609, 660, OPEN),
    (ReportKind::Label, 609, 660, OPEN),
];

#[test]
fn labels_begin_after_600_samples_the_look_ahead_and_the_median() {
    let mut pipeline = pipeline();
    let boot = pipeline.state_report();
    assert_eq!(fields([boot]), [safe(0, Cause::Boot)]);
    assert_eq!(fields(feed(&mut pipeline, 0, 660, 1)), []);
    assert_eq!(fields(feed(&mut pipeline, 660, 1, 1)), FIRST_VALID);
    let next = feed(&mut pipeline, 661, 40, 1);
    let label = |instant, emitted| (ReportKind::Label, instant, emitted, OPEN);
    let expected = [label(629, 680), label(649, 700)];
    assert_eq!(fields(next.iter().copied()), expected);
    assert_eq!(next[1].sequence, boot.sequence + 4);
    assert_eq!(pipeline.window.counters, Counters::default());
}

#[test]
fn a_normalizing_pipeline_gives_the_labels_of_normalized_samples_and_knows_the_wearer_after_a_gap()
{
    let [mut normalizing, mut plain] = [(); 2].map(|()| pipeline());
    normalizing.preprocess(Preprocessing {
        normalized: true,
        ..Preprocessing::default()
    });
    let mut wearer = Normalizer::default();
    let mut labels = 0;
    for index in 0..6000 {
        if index == 3000 {
            for pipeline in [&mut normalizing, &mut plain] {
                let _ = pipeline.gap(at(index), 50);
                let _ = pipeline.disconnected(at(index));
            }
        }
        let now = at(index + if index < 3000 { 0 } else { 50 });
        // Rest and contractions of a second.
        let strength = if index / 200 % 2 == 0 { 3 } else { 40 };
        let sample = constant((index * index % 61 % strength) as i8);
        let reports = fields(normalizing.sample(now, sample));
        labels += reports.len();
        assert_eq!(reports, fields(plain.sample(now, wearer.push(sample))));
    }
    assert!(labels > 200, "{labels}");
}

#[test]
fn five_lost_samples_are_bridged_by_the_last_one() {
    let mut pipeline = pipeline();
    assert_eq!(fields(feed(&mut pipeline, 0, 650, 1)), []);
    assert_eq!(fields(pipeline.gap(at(655), 5)), []);
    let reports = feed(&mut pipeline, 655, 6, 1);
    assert_eq!(fields(reports.iter().copied()), FIRST_VALID);
    let expected = counters([5, 5, 0]);
    assert_eq!(reports[1].counters, expected);
}

#[test]
fn a_label_can_fall_due_on_a_bridged_sample() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 658, 1);
    assert_eq!(fields(pipeline.gap(at(663), 5)), FIRST_VALID);
}

#[test]
fn six_lost_samples_reset_the_window() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let reports = pipeline.gap(at(667), 6);
    assert_eq!(fields(reports), [safe(666, Cause::Gap)]);
    let expected = counters([6, 0, 1]);
    assert_eq!(pipeline.window.counters, expected);
    assert!(pipeline.network.state.is_empty(), "the model is not reset");
    // A second gap before any sample resets nothing.
    assert_eq!(fields(pipeline.gap(at(668), 1)), []);
    assert_eq!(pipeline.window.counters.resets, 1);

    // The new window begins at sample 668.
    assert_eq!(fields(feed(&mut pipeline, 668, 660, 1)), []);
    let later =
        |(kind, instant, emitted, status): Fields| (kind, 668 + instant, 668 + emitted, status);
    let found = fields(feed(&mut pipeline, 668 + 660, 1, 1));
    assert_eq!(found, FIRST_VALID.map(later));
}

#[test]
fn the_quota_of_bridged_samples_is_exact_and_has_its_own_cause() {
    // Gaps of five samples with one sample between them.
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let mut index = 661;
    for _ in 0..12 {
        let mut reports = pipeline.gap(at(index), 5).into_iter();
        assert!(reports.all(|report| report.kind == ReportKind::Label));
        index += 5;
        feed(&mut pipeline, index, 1, 1);
        index += 1;
    }
    assert!(pipeline.status().valid());
    assert_eq!(pipeline.window.ring.bridged(), 60);
    let before = pipeline.window.counters;
    let reports = pipeline.gap(at(index), 1);
    assert_eq!(fields(reports), [safe(index, Cause::Losses)]);
    let expected = counters([before.lost + 1, 60, 1]);
    assert_eq!(pipeline.window.counters, expected);
    assert!(pipeline.network.state.is_empty(), "the model is not reset");
    // A full window is needed to be valid again.
    index += 1;
    assert_eq!(fields(feed(&mut pipeline, index, 660, 1)), []);
    assert_eq!(fields(feed(&mut pipeline, index + 660, 1, 1)).len(), 2);
}

#[test]
fn silence_and_disconnection_reset_the_window() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    assert_eq!(pipeline.deadline(), Some(Millis(3500)));
    assert_eq!(fields(pipeline.tick(Millis(3499))), []);
    let reports = pipeline.tick(Millis(3500));
    assert_eq!(fields(reports), [safe(660, Cause::Silence)]);
    assert_eq!(pipeline.status(), Status::Safe(Cause::Silence));
    assert!(pipeline.network.state.is_empty(), "the model is not reset");
    let reports = pipeline.disconnected(Millis(4000));
    assert_eq!(fields(reports), [safe(660, Cause::Disconnected)]);
    assert_eq!(pipeline.window.counters.resets, 1);
    assert_eq!(pipeline.deadline(), None);
    assert_eq!(fields(feed(&mut pipeline, 661, 660, 1)), []);
}

#[test]
fn a_stall_needs_a_full_window_to_be_valid_again() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let reports = pipeline.stalled(at(661));
    assert_eq!(fields(reports), [safe(660, Cause::Stalled)]);
    assert_eq!(fields(feed(&mut pipeline, 661, 660, 1)), []);
    assert_eq!(fields(feed(&mut pipeline, 661 + 660, 1, 1)).len(), 2);
}

#[test]
fn a_sample_after_a_silence_reports_it_without_a_tick() {
    let mut pipeline = pipeline();
    feed(&mut pipeline, 0, 661, 1);
    let reports = pipeline.sample(Millis(3600), constant(1));
    assert_eq!(fields(reports), [safe(660, Cause::Silence)]);
    assert_eq!(pipeline.window.ring.contiguous(), 0);
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
            [[0.0; MAX_LOGITS]; LOOK_BACK]
        }
    }
    let refused = Pipeline::new(Seven, &mut (), Settings::PAPER_IN_PATCHES).err();
    assert_eq!(refused, Some(SettingsError::Classes { most: 6, found: 7 }));
}

/// The labels of a recording without gaps, each step over the whole recording.
fn expected_labels(recording: &[Sample]) -> Vec<(u32, Status)> {
    // The last sample's median needs a sample that has not arrived.
    let mut samples: Vec<_> = clean(recording.iter().copied(), Median::Three).collect();
    samples.pop();
    let patches = samples.as_chunks::<PATCH>().0.iter();
    let sums: Vec<usize> = patches
        .map(|patch| patch.iter().map(|sample| usize::from(sample[0])).sum())
        .collect();
    // The window that ends with patch 59 is the first; all rows of windows p ... p + 5.
    let label = |end: usize| {
        let mut votes = [0; 3];
        for window in end - 5..=end {
            for patch in end - 5..=window {
                votes[sums[patch] % 3] += 1;
            }
        }
        let most = votes.iter().max();
        let class = votes.iter().position(|count| Some(count) == most);
        let intent = class.and_then(Intent::from_class).unwrap();
        ((end as u32 - 5) * 10 + 9, Status::Valid(intent))
    };
    (65..sums.len()).step_by(2).map(label).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn the_pipeline_equals_its_steps_one_after_another(
        recording in prop::collection::vec(any::<Sample>(), 600..1200),
    ) {
        let mut pipeline = pipeline();
        let (reports, _) = run(&mut pipeline, &recording, 0..recording.len());
        // Windows 6, 8, ...: the first label is that of the first even window past the look-ahead.
        prop_assert_eq!(labels(reports, 0), expected_labels(&recording));
    }
}

mod alignment;
mod arm;
mod calibration;
mod instants;
mod wrap;

#[test]
fn a_lock_shows_no_label_before_an_open_hand_is_held_and_none_after_the_stream_was_lost() {
    let mut pipeline = pipeline();
    pipeline.set_lock(Some(LockTimes {
        sign: 200,
        rest: 400,
    }));
    let close = Status::Valid(Intent::Close);
    let relax = Status::Valid(Intent::Relax);
    let locked = Status::Safe(Cause::Locked);
    // A close hand says only that it is locked.
    let reports = feed(&mut pipeline, 0, 1000, 2);
    assert_eq!(fields(reports), [safe(660, Cause::Locked)]);
    // The sign itself is shown as relax.
    let reports = feed(&mut pipeline, 1000, 400, 1);
    let shown: Vec<Status> = fields(reports).iter().map(|own| own.3).collect();
    assert!(!shown.is_empty() && shown.iter().all(|own| *own == relax));
    let reports = feed(&mut pipeline, 1400, 200, 2);
    assert_eq!(fields(reports).last().unwrap().3, close);
    // Two seconds of rest lock again.
    let reports = feed(&mut pipeline, 1600, 600, 0);
    assert_eq!(fields(reports).last().unwrap().3, locked);
    pipeline.hold_lock(false);
    let reports = feed(&mut pipeline, 2200, 100, 2);
    assert_eq!(fields(reports).last().unwrap().3, close);
    pipeline.disconnected(at(2300));
    let reports = feed(&mut pipeline, 2300, 800, 2);
    assert_eq!(fields(reports).last().unwrap().3, locked);
    // Without a lock labels go on.
    pipeline.set_lock(None);
    let reports = feed(&mut pipeline, 3100, 100, 2);
    assert_eq!(fields(reports).last().unwrap().3, close);
}
