//! Alignment while the stream continues, with a real encoder.

mod exchange;

use super::*;
use crate::intent::Vocabulary;
use crate::model::dimensions::Dimensions;
use crate::model::encoder::Encoder;
use crate::model::file::{Model, random::random_model};
use crate::model::noise::Noise;
use crate::stream::alignment::{Alignment, Arm};
use crate::uart_line::alignment::AlignmentState;

pub(super) type SmallEncoder = Encoder<'static, 16, 54>;
type SmallPipeline = Pipeline<'static, SmallEncoder>;

/// A pipeline of a random model with the template of a ramp round the arm.
pub(super) fn real() -> SmallPipeline {
    let (encoder, _, input) = model_of(3);
    let mut pipeline = pipeline_of(encoder, EACH_PATCH);
    pipeline.set_template(input.template);
    pipeline
}

/// Samples of noise, whose amplitude falls round the arm as the template does, on the electrodes of an armband placed
/// like this; gestures are four times as strong as the rest between.
fn stream(alignment: Alignment, count: u32) -> Vec<Sample> {
    stream_of([118, 86, 62, 44, 32, 24, 16, 12], alignment, count)
}

/// A stream with gestures of another amplitude round the arm, from sample 800 on in the first half of every 400 samples.
pub(super) fn stream_of(open: [i32; CHANNELS], alignment: Alignment, count: u32) -> Vec<Sample> {
    let mut noise = Noise(9);
    (0..count)
        .map(|index| {
            let is_active = index >= 800 && index % 400 < 200;
            let sample = open.map(|most: i32| {
                let most = if is_active { most } else { 4 };
                ((noise.signed() * most as f32) as i32).clamp(-127, 127) as i8
            });
            alignment.inverse().apply(sample)
        })
        .collect()
}

/// The newest state that the line has not said yet.
fn state(pipeline: &mut SmallPipeline) -> Option<AlignmentState> {
    pipeline.take_alignment_report().map(|news| news.state)
}

/// Most samples from one label to the next.
pub(super) fn longest_pause(reports: &[Report]) -> Option<u32> {
    let emitted: Vec<u32> = reports
        .iter()
        .filter(|report| report.kind == ReportKind::Label)
        .map(|report| report.emitted.0)
        .collect();
    emitted.windows(2).map(|two| two[1] - two[0]).max()
}

#[test]
fn two_openings_align_and_later_labels_are_those_of_an_armband_in_place() {
    let mut expected = real();
    let in_place = run(&mut expected, &stream(Alignment::NONE, 3000), 0..3000).0;
    for worn in [Alignment::new(3, false), Alignment::new(6, true)] {
        let mut pipeline = real();
        pipeline.begin_alignment(Arm::Unknown);
        let (reports, news) = run(&mut pipeline, &stream(worn, 3000), 0..3000);
        let states: Vec<_> = news
            .iter()
            .map(|news| (news.state, news.gestures))
            .collect();
        let (waiting, aligned) = (AlignmentState::Waiting, AlignmentState::Aligned);
        assert_eq!(states, [(waiting, 0), (waiting, 1), (aligned, 2)]);
        assert_eq!((pipeline.alignment(), news[2].alignment), (worn, worn));
        // The second gesture ends at sample 1400.
        let done = news[2].emitted.0;
        assert!((1400..1500).contains(&done), "{done}");
        // One patch a sample: 60 that were there and those that came meanwhile.
        let longest = longest_pause(&reports);
        let after = labels(reports, done + 1);
        let first = after[0].0;
        assert!(first <= done + 30, "{first} {done}");
        assert_eq!(after, labels(in_place.iter().copied(), first));
        let changes = after.iter().any(|label| label.1 != after[0].1);
        assert!(changes, "one label for all");
        assert!(longest <= Some(80), "{longest:?}");
        assert!(pipeline.status().valid());
    }
}

#[test]
fn who_opens_no_hand_is_told_after_30_seconds_and_nothing_changes() {
    let mut pipeline = real();
    pipeline.begin_alignment(Arm::Unknown);
    let rest = stream_of([4; CHANNELS], Alignment::NONE, 6200);
    let (_, news) = run(&mut pipeline, &rest, 0..6200);
    let states: Vec<_> = news.iter().map(|news| news.state).collect();
    assert_eq!(states, [AlignmentState::Waiting, AlignmentState::Timeout]);
    assert_eq!(pipeline.alignment(), Alignment::NONE);
    assert!(pipeline.status().valid());
}

#[test]
fn a_gap_keeps_the_alignment_and_a_disconnection_drops_it() {
    let worn = Alignment::new(2, true);
    let mut pipeline = real();
    pipeline.set_alignment(worn);
    assert_eq!(state(&mut pipeline), Some(AlignmentState::Set));
    run(&mut pipeline, &stream(worn, 700), 0..700);
    pipeline.gap(at(800), 100);
    pipeline.stalled(at(800));
    pipeline.tick(Millis(9000));
    assert_eq!(pipeline.alignment(), worn);
    assert_eq!(pipeline.take_alignment_report(), None);
    pipeline.disconnected(Millis(9100));
    let news = pipeline.take_alignment_report().unwrap();
    assert_eq!(
        (news.state, news.alignment),
        (AlignmentState::Disconnected, Alignment::NONE)
    );
    pipeline.disconnected(Millis(9200));
    assert_eq!(pipeline.take_alignment_report(), None, "nothing to drop");
}

#[test]
fn without_a_template_nothing_begins_and_on_request_it_ends() {
    let mut pipeline = real();
    pipeline.set_template(None);
    pipeline.begin_alignment(Arm::Unknown);
    assert_eq!(state(&mut pipeline), Some(AlignmentState::Unavailable));
    pipeline.cancel_alignment();
    assert_eq!(state(&mut pipeline), None);
    let mut pipeline = real();
    pipeline.begin_alignment(Arm::Unknown);
    pipeline.cancel_alignment();
    assert_eq!(state(&mut pipeline), Some(AlignmentState::Cancelled));
    let (_, news) = run(&mut pipeline, &stream(Alignment::NONE, 1600), 0..1600);
    assert_eq!(news, []);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whenever the alignment changes, before the window is full too: what comes out later is the same.
    #[test]
    fn a_change_at_any_time_is_as_if_it_had_always_been(
        change in 0_u32..900,
        (turn, mirrored) in (0_u8..8, any::<bool>()),
        (gap, missing) in (0_u32..900, 0_u32..8),
    ) {
        let worn = Alignment::new(turn, mirrored);
        let samples = stream(worn, 1700);
        let mut always = real();
        always.set_alignment(worn);
        let mut late = real();
        let [mut expected, mut found] = [Vec::new(), Vec::new()];
        for (index, &sample) in (0..).zip(&samples) {
            if index == change {
                late.set_alignment(worn);
            }
            if index == gap && missing > 0 {
                expected.extend(always.gap(at(index), missing));
                found.extend(late.gap(at(index), missing));
            }
            expected.extend(always.sample(at(index), sample));
            found.extend(late.sample(at(index), sample));
        }
        prop_assert_eq!(labels(found, change + 31), labels(expected, change + 31));
    }
}

#[test]
fn the_phase_is_that_of_the_newest_alignment_that_succeeded() {
    let mut pipeline = real();
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::None);
    pipeline.begin_alignment(Arm::Unknown);
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::Waiting);
    pipeline.cancel_alignment();
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::None);
    pipeline.begin_alignment(Arm::Unknown);
    // In place: nothing is turned, and yet it is known now.
    run(&mut pipeline, &stream(Alignment::NONE, 1600), 0..1600);
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::Aligned);
    pipeline.begin_alignment(Arm::Unknown);
    pipeline.cancel_alignment();
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::Aligned);
    pipeline.disconnected(Millis(9000));
    assert_eq!(pipeline.alignment_phase(), AlignmentPhase::None);
}

#[test]
fn labels_of_a_shorter_look_ahead_do_not_come_twice_after_an_alignment() {
    for look_ahead in 0..LOOK_BACK {
        for begun in 800..810 {
            let instants = instants(look_ahead, begun);
            assert!(instants.len() > 20);
            let rising = instants.is_sorted_by(|one, next| one < next);
            assert!(rising, "look-ahead {look_ahead}, at {begun}: {instants:?}");
        }
    }
}

/// Reference times of the labels of a stream that is aligned at a sample.
fn instants(look_ahead: usize, aligned_at: usize) -> Vec<u32> {
    let settings = Settings {
        look_ahead,
        ..EACH_PATCH
    };
    let mut pipeline = pipeline_of(SumModel, settings);
    let samples = [constant(1); 1000];
    let (mut reports, _) = run(&mut pipeline, &samples, 0..aligned_at);
    pipeline.set_alignment(Alignment::new(3, false));
    reports.extend(run(&mut pipeline, &samples, aligned_at..1000).0);
    labels(reports, 0)
        .into_iter()
        .map(|(instant, _)| instant)
        .collect()
}

pub(super) fn model_of(seed: u64) -> (SmallEncoder, Smoother, ModelInput) {
    let dimensions = Dimensions::new(Vocabulary::Three, 16, 2, 27);
    let bytes: &'static [u8] = random_model(dimensions, seed).to_bytes().unwrap().leak();
    let model = Model::parse(bytes).unwrap();
    let smoother = Smoother::new(EACH_PATCH, 3).unwrap();
    let input = ModelInput {
        preprocessing: Preprocessing::default(),
        template: model.header.template,
        alignment: Alignment::NONE,
    };
    (SmallEncoder::new(&model).unwrap(), smoother, input)
}
