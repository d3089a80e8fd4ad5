//! A wearer who does what is asked for, or something else.

use super::*;
use crate::calibration::{Memory, Shown, from_record};
use crate::intent::Vocabulary;
use crate::model::dimensions::Dimensions;
use crate::model::encoder::DeviceEncoder;
use crate::model::file::Model;
use crate::model::file::random::random_model;
use crate::model::noise::Noise;
use crate::stream::alignment::{Alignment, Arm};
use crate::uart_line::answer::Refusal;
use crate::uart_line::calibration::{CalibrateCommand, CalibrationReport};

type DevicePipeline = Pipeline<'static, DeviceEncoder<'static>>;

struct Wearer {
    model: Model<'static>,
    pipeline: DevicePipeline,
    noise: Noise,
    index: u32,
    cue: Shown,
    said: Vec<CalibrationReport>,
}

impl Wearer {
    /// A wearer after the first label, with a calibration begun.
    fn new(seed: u64) -> Self {
        let dimensions = Dimensions {
            other: true,
            ..Dimensions::new(Vocabulary::Three, 16, 1, 27)
        };
        let file: &'static [u8] = random_model(dimensions, seed).to_bytes().unwrap().leak();
        let model = Model::parse(file).unwrap();
        let encoder = DeviceEncoder::new(&model).unwrap();
        let mut settings = Settings::PAPER_IN_PATCHES;
        settings.margins.other = Some(0.0);
        let pipeline = pipeline_of(encoder, settings);
        let mut wearer = Self {
            model,
            pipeline,
            noise: Noise(7),
            index: 0,
            cue: Shown::Intent(Intent::Relax),
            said: Vec::new(),
        };
        let begin = |wearer: &mut Self, streams| {
            let begin = CalibrateCommand::Begin { others: false };
            let begun = wearer
                .pipeline
                .calibrate(at(0), begin, streams, Arm::Unknown);
            let report = wearer.pipeline.take_calibration_report();
            (begun.err(), report.map(|report| report.state))
        };
        assert_eq!(begin(&mut wearer, false), (Some(Refusal::NoStream), None));
        // There is no memory.
        let unavailable = Some(CalibrationState::Unavailable);
        assert_eq!(begin(&mut wearer, true), (None, unavailable));
        wearer.pipeline.lend(Box::leak(Box::new(Memory::EMPTY)));
        assert!(!wearer.moves(700, |cue| cue).is_empty());
        let begun = wearer
            .pipeline
            .begin_calibration(at(wearer.index), false, Arm::Unknown);
        let begun: Vec<_> = begun.unwrap().into_iter().collect();
        assert_eq!(begun[0].status, Status::Safe(Cause::Installation));
        wearer.hear();
        wearer
    }

    fn hear(&mut self) {
        if let Some(report) = self.pipeline.take_calibration_report() {
            self.cue = report.cue.unwrap_or(self.cue);
            self.said.push(report);
        }
    }

    /// Passes samples, each made from the cue; returns the reports.
    fn moves(&mut self, samples: u32, made: impl Fn(Shown) -> Shown) -> Vec<Report> {
        let mut reports = Vec::new();
        for _ in 0..samples {
            let strongest = match made(self.cue) {
                Shown::Intent(Intent::Relax) => CHANNELS,
                Shown::Intent(intent) => 3 * intent.class(),
                Shown::Other => 7,
            };
            let sample = core::array::from_fn(|channel| {
                let most = if channel == strongest { 100.0 } else { 6.0 };
                (self.noise.signed() * most) as i8
            });
            reports.extend(self.pipeline.sample(at(self.index), sample));
            self.index += 1;
            self.hear();
        }
        reports
    }

    fn last(&self) -> &'static str {
        self.said.last().unwrap().state.name()
    }
}

/// Samples of a round: four cues of 4 s.
const ROUND: u32 = 3200;
const GESTURE: Shown = Shown::Intent(Intent::Open);

#[test]
fn who_does_nothing_is_told_and_labels_go_on() {
    let mut wearer = Wearer::new(3);
    wearer.moves(ROUND, |_| Shown::Intent(Intent::Relax));
    assert_eq!(wearer.last(), "weak");
    assert!(wearer.pipeline.status().valid());
    assert!(wearer.pipeline.take_learnt().is_none());
}

#[test]
fn who_follows_the_cues_gets_a_head_and_no_label_meanwhile() {
    let mut wearer = Wearer::new(3);
    assert_eq!(wearer.moves(2 * ROUND + 80, |cue| cue), []);
    let states: Vec<_> = wearer.said.iter().map(|own| own.state.name()).collect();
    let mut expected = ["teaching"; 9];
    expected[4..8].fill("judging");
    expected[8] = "keeping";
    assert_eq!(states, expected);
    let recalls = wearer.said[8].recalls.unwrap();
    let is_better = recalls.learnt >= 900 && recalls.learnt > recalls.before;
    assert!(is_better, "{recalls:?}");
    let before = wearer.moves(200, |cue| cue);
    assert_eq!(before, [], "a label before it is kept");
    let memory = wearer.pipeline.take_learnt().unwrap();
    assert!(wearer.pipeline.take_learnt().is_none());
    let record = memory.record(wearer.model.checksum);
    assert!(from_record(record, &wearer.model).is_ok());
    // Labels go on with the memory, whatever became of the head.
    wearer.pipeline.lend(memory);
    assert!(wearer.moves(60, |cue| cue)[0].status.valid());
}

#[test]
fn a_head_that_is_worse_in_round_two_is_given_up() {
    // The gestures are exchanged in round two. A model whose own head does better there than none.
    let mut worse = 0;
    for seed in 0..12 {
        let mut wearer = Wearer::new(seed);
        wearer.moves(ROUND + 60, |cue| cue);
        let reports = wearer.moves(ROUND + 80, |cue| match cue {
            GESTURE => Shown::Intent(Intent::Close),
            Shown::Intent(Intent::Close) => GESTURE,
            rest => rest,
        });
        let recalls = wearer.said.last().unwrap().recalls.unwrap();
        let is_worse = recalls.learnt + 50 < recalls.before;
        assert_eq!(wearer.last(), if is_worse { "worse" } else { "keeping" });
        assert_eq!(wearer.pipeline.take_learnt().is_some(), !is_worse);
        assert_eq!(reports.is_empty(), !is_worse);
        worse += u32::from(is_worse);
    }
    assert!(worse > 0);
}

#[test]
fn losses_are_borne_up_to_a_gap_and_whatever_else_ends_it_changes_nothing() {
    let mut wearer = Wearer::new(3);
    for _ in 0..30 {
        wearer.moves(195, |cue| cue);
        let now = at(wearer.index);
        let _ = wearer.pipeline.gap(now, 5);
        wearer.index += 5;
    }
    wearer.moves(480, |cue| cue);
    assert_eq!(wearer.last(), "keeping");

    type End = fn(&mut DevicePipeline, Millis);
    const TURNED: Alignment = Alignment::new(1, false);
    let ends: [(&str, End); 6] = [
        ("interrupted", |own, now| _ = own.gap(now, 6)),
        ("interrupted", |own, now| _ = own.disconnected(now)),
        ("interrupted", |own, now| _ = own.suspend(now)),
        ("cancelled", |own, _| own.begin_alignment(Arm::Unknown)),
        ("cancelled", |own, _| own.set_alignment(TURNED)),
        ("cancelled", |own, _| assert!(own.cancel_calibration())),
    ];
    for (state, end) in ends {
        for samples in [10, 1000, ROUND + 30, ROUND + 1000] {
            let mut wearer = Wearer::new(3);
            wearer.moves(samples, |cue| cue);
            let now = at(wearer.index);
            end(&mut wearer.pipeline, now);
            wearer.hear();
            assert_eq!(wearer.last(), state);
            assert!(!wearer.pipeline.cancel_calibration());
            let reports = wearer.moves(800, |cue| cue);
            let has_labels = reports.iter().any(|own| own.status.valid());
            assert_eq!(has_labels, wearer.pipeline.has_model());
            assert!(wearer.pipeline.take_learnt().is_none());
        }
    }
}
