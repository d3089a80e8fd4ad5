//! Decisions of the model on which arm the armband is.

mod interrupted;

use super::alignment::{longest_pause, model_of, real, stream_of};
use super::*;
use crate::stream::alignment::{Alignment, Arm, NAT, Template};
use crate::uart_line::alignment::AlignmentState;

/// A model to which a hand opens where electrode 1 is stronger than electrode 7, or the other way round. On the other arm
/// these two change places.
#[derive(Clone, Copy)]
struct Sided {
    mirrored: bool,
}

impl Encode for Sided {
    type State = u32;

    fn classes(&self) -> usize {
        3
    }

    fn fresh(&self) -> u32 {
        0
    }

    fn reset(&self, state: &mut u32) {
        *state = 0;
    }

    fn step(&self, state: &mut u32, patch: &Patch) -> LookBackLogits {
        *state += 1;
        let sum = |electrode: usize| -> f32 {
            let values = patch.iter().map(|sample| f32::from(sample[electrode]));
            values.sum()
        };
        let open = if self.mirrored {
            sum(7) - sum(1)
        } else {
            sum(1) - sum(7)
        };
        let mut rows = [[0.0; MAX_LOGITS]; LOOK_BACK];
        for row in &mut rows {
            row[Intent::Open.class()] = open;
        }
        rows
    }
}

/// An open hand that is the same on both arms.
fn symmetrical() -> Template {
    Template::round([400, 200, 0, -200, -300, -200, 0, 200], 2).unwrap()
}

/// Two openings of it that end at the samples 1000 and 1400, stronger on electrode 1 than on electrode 7.
fn stream(worn: Alignment, count: u32) -> Vec<Sample> {
    stream_of([118, 82, 40, 23, 17, 23, 40, 58], worn, count)
}

fn sided(mirrored: bool) -> Pipeline<'static, Sided> {
    let mut pipeline = pipeline_of(Sided { mirrored }, EACH_PATCH);
    pipeline.set_template(Some(symmetrical()));
    pipeline
}

/// A pipeline with a real encoder, which has some opinion of the openings.
fn undecided() -> Pipeline<'static, super::alignment::SmallEncoder> {
    let mut pipeline = real();
    pipeline.set_template(Some(symmetrical()));
    pipeline
}

/// The sample with which the decision begins, in a stream whose alignment begins with the first sample.
fn begins<E: Encode>(mut pipeline: Pipeline<'_, E>) -> usize {
    pipeline.begin_alignment(Arm::Unknown);
    let samples = stream(Alignment::NONE, 2000);
    let first = (0..2000).find(|&index| {
        run(&mut pipeline, &samples, index..index + 1);
        pipeline.arm_decision().is_some()
    });
    first.expect("a decision")
}

#[test]
fn the_model_tells_the_arm_that_the_template_does_not_however_the_armband_is_turned() {
    for worn in Alignment::all() {
        let mirrored = Alignment::new(worn.turn(), !worn.mirrored());
        for (model, expected) in [(false, worn), (true, mirrored)] {
            let mut pipeline = sided(model);
            pipeline.begin_alignment(Arm::Unknown);
            let (_, news) = run(&mut pipeline, &stream(worn, 2000), 0..2000);
            let last = news[2];
            assert_eq!((last.state, last.gestures), (AlignmentState::Aligned, 2));
            assert_eq!((last.alignment, pipeline.alignment()), (expected, expected));
        }
    }
}

#[test]
fn the_arm_that_is_told_is_not_asked_of_the_model_whatever_is_in_force() {
    for worn in Alignment::all() {
        for in_force in [Alignment::NONE, Alignment::new(3, true)] {
            // The model takes the other arm's.
            let mut pipeline = sided(true);
            pipeline.set_alignment(in_force);
            pipeline.begin_alignment(Arm::Known {
                mirrored: worn.mirrored(),
            });
            let (_, news) = run(&mut pipeline, &stream(worn, 1500), 0..1500);
            assert!(pipeline.arm_decision().is_none());
            let last = news.last().unwrap();
            assert_eq!(last.state, AlignmentState::Aligned);
            assert_eq!(last.alignment, worn);
        }
    }
}

#[test]
fn the_alignment_in_force_is_what_both_placements_are_seen_from() {
    let worn = Alignment::new(5, true);
    for before in Alignment::all() {
        let mut pipeline = sided(false);
        pipeline.set_alignment(before);
        pipeline.begin_alignment(Arm::Unknown);
        run(&mut pipeline, &stream(worn, 2000), 0..2000);
        assert_eq!(pipeline.alignment(), worn);
    }
}

/// The mean over the rows that refer to the openings, as plainly as it can be computed: all patches at once, from a list.
fn naive<E: Encode>(encoder: &E, patches: &[Patch], placed: Alignment, openings: &[bool]) -> f32 {
    let mut state = encoder.fresh();
    let mut sum = 0.0;
    let mut rows = 0;
    for (newest, patch) in patches.iter().enumerate() {
        let logits = encoder.step(&mut state, &patch.map(|sample| placed.apply(sample)));
        for (back, row) in logits.iter().enumerate().take(newest + 1) {
            if openings[newest - back] {
                sum += row[1] - row[0].max(row[2]);
                rows += 1;
            }
        }
    }
    sum / rows as f32
}

#[test]
fn a_real_encoders_decision_is_that_of_its_logits_over_the_window() {
    let start = begins(undecided());
    for worn in [Alignment::NONE, Alignment::new(6, true)] {
        let samples = stream(worn, 2000);
        let mut pipeline = undecided();
        pipeline.begin_alignment(Arm::Unknown);
        run(&mut pipeline, &samples, 0..start + 1);
        // The window then: the encoder has just taken its first patch.
        let ring = &pipeline.window.ring;
        let patches: Vec<Patch> = (0..53)
            .rev()
            .map(|back| *ring.before_newest(back))
            .collect();
        // A patch of 10 samples, of which the newest is `newest_end`, wholly within patches that the alignment saw active.
        let first = pipeline.window.newest_end.0 as usize + 1 - 530;
        let is_open = |patch: usize| {
            let begin = first + 10 * patch;
            let within = |end: usize| begin + 9 < end && begin + 200 >= end;
            within(1000) || within(1400)
        };
        let openings: Vec<bool> = (0..53).map(is_open).collect();
        assert!(openings.iter().filter(|&&open| open).count() > 20);
        let fits = pipeline.arm_decision().unwrap().fits();
        let places = [fits.nearest, fits.other_arm].map(|fit| fit.alignment);
        let (encoder, ..) = model_of(3);
        let [nearest, other] = places.map(|placed| naive(&encoder, &patches, placed, &openings));
        let (nats, lead) = (1.5 * (other - nearest), fits.lead() as f32 / NAT as f32);
        assert!((nats - lead).abs() > 0.01, "a choice that is no choice");
        run(&mut pipeline, &samples, start + 1..2000);
        assert_eq!(pipeline.alignment(), places[usize::from(nats > lead)]);
    }
}

#[test]
fn no_sample_is_lost_while_the_model_decides_and_labels_are_those_of_an_armband_in_place() {
    let samples = stream(Alignment::new(2, false), 3000);
    let mut pipeline = undecided();
    pipeline.begin_alignment(Arm::Unknown);
    let (reports, news) = run(&mut pipeline, &samples, 0..3000);
    let found = pipeline.alignment();
    let done = news[2].emitted.0;
    let begun = begins(undecided()) as u32;
    // A patch with each sample: 53 for each arm.
    assert_eq!(done, begun + 105);

    let mut always = undecided();
    always.set_alignment(found);
    let expected = run(&mut always, &samples, 0..3000).0;
    let longest = longest_pause(&reports);
    let found = labels(reports, done);
    assert!(found[0].0 <= done + 30, "{} {done}", found[0].0);
    assert_eq!(found, labels(expected, found[0].0));
    assert!(longest <= Some(180), "{longest:?}");
    assert!(pipeline.status().valid());
    assert_eq!(pipeline.window.counters, Counters::default());
}

#[test]
fn samples_that_are_filled_in_do_not_end_a_decision() {
    let start = begins(sided(false));
    let worn = Alignment::new(4, true);
    let samples = stream(worn, 2000);
    let mut pipeline = sided(false);
    pipeline.begin_alignment(Arm::Unknown);
    run(&mut pipeline, &samples, 0..start + 30);
    let _ = pipeline.gap(at(start as u32 + 34), 5);
    assert!(pipeline.arm_decision().is_some());
    run(&mut pipeline, &samples, start + 35..2000);
    assert_eq!(pipeline.alignment(), worn);
}

#[test]
fn without_a_model_nobody_decides() {
    let mut pipeline = undecided();
    let samples = stream(Alignment::new(3, true), 2000);
    let _ = pipeline.suspend(Millis(0));
    pipeline.begin_alignment(Arm::Unknown);
    let (_, news) = run(&mut pipeline, &samples, 0..2000);
    let states: Vec<_> = news.iter().map(|news| news.state).collect();
    let waiting = AlignmentState::Waiting;
    assert_eq!(states, [waiting, waiting, AlignmentState::PoorMargin]);
    assert_eq!(pipeline.alignment(), Alignment::NONE);
}

#[test]
fn a_window_that_is_not_full_is_taken_as_far_as_it_goes() {
    // A gap just before the second opening.
    let worn = Alignment::new(1, true);
    let samples = stream(worn, 2000);
    let mut pipeline = sided(false);
    pipeline.begin_alignment(Arm::Unknown);
    run(&mut pipeline, &samples, 0..1080);
    let _ = pipeline.gap(at(1090), 10);
    let (_, news) = run(&mut pipeline, &samples, 1090..2000);
    assert_eq!(pipeline.alignment(), worn);
    // Some 33 patches for each arm instead of 53.
    let done = news.last().unwrap().emitted.0;
    assert!(done < 1440 + 2 * 40, "{done}");
}
