//! Instructions of an alignment: while gestures are waited for, while the model decides on the arm, at its end, and while
//! the encoder takes the window again.

use core::hint::black_box;

use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::{AlignmentPhase, Pipeline};
use shared::stream::alignment::{Alignment, Arm, Profile, Template};
use shared::units::{CHANNELS, Millis, PATCH, SAMPLE_PERIOD_MS, Sample};

use crate::spans::{Clock, Spans};

/// Amplitude of a gesture round the arm, in counts; a ratio of about 1.37 from one electrode to the next.
pub const GESTURE: [i32; CHANNELS] = [118, 86, 62, 44, 32, 24, 16, 12];
/// Amplitude of a gesture that does not tell the arm, in counts.
const SYMMETRICAL: [i32; CHANNELS] = [118, 68, 40, 23, 17, 23, 40, 68];
/// Amplitude of rest.
pub const REST: i32 = 4;
/// Samples of the wearer's two gestures, of a second each, after rest until the window is full.
const GESTURES: [core::ops::Range<usize>; 2] = [1000..1200, 1400..1600];
/// The sample before which the alignment begins; with it a patch begins, as the median lags one sample.
const BEGINS: usize = 801;
const SAMPLES: usize = 2000;
/// Samples after the end in each of which the encoder takes a patch: 60 that were there, and those that come meanwhile.
pub const AGAIN: usize = 66;
/// Samples of a decision between the arms, in each of which the encoder takes a patch: 53 for either.
const DECISION: usize = 106;

/// A template of this mean, 2 nats per square octave in every direction.
fn about(mean: [i16; CHANNELS]) -> Template {
    Template::round(mean, 2).expect("means below 8 octaves, a positive diagonal")
}

/// A template that falls round the arm as the gesture does.
fn ramp() -> Template {
    about([400, 285, 170, 55, -60, -175, -290, -405])
}

/// The stream of an armband that is turned by three places.
fn samples(gesture: [i32; CHANNELS]) -> impl Iterator<Item = Sample> {
    let worn = Alignment::new(3, false).inverse();
    let mut noise = noise();
    (0..SAMPLES).map(move |index| {
        let is_gesture = GESTURES.iter().any(|gesture| gesture.contains(&index));
        let sample = gesture.map(|most| noise(if is_gesture { most } else { REST }) as i8);
        worn.apply(sample)
    })
}

/// Noise of an amplitude, both ends included.
pub fn noise() -> impl FnMut(i32) -> i32 {
    let mut state = 1_u64;
    move |amplitude| {
        // Knuth's linear congruential generator; its high bits are the random ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % (2 * amplitude as u64 + 1)) as i32 - amplitude
    }
}

/// Counts one alignment, by the names of its parts.
///
/// # Panics
/// If the placement is not found: then something else was counted.
pub fn count<E: Encode + Copy>(encoder: E, model: &Model<'_>) -> [(&'static str, Spans); 6] {
    let mut memory = encoder.fresh();
    let mut pipeline = Pipeline::of_model(model, encoder, &mut memory).expect("good settings");
    pipeline.set_template(Some(ramp()));
    let clock = Clock::new();
    let [mut waiting, mut end, mut again, mut fit, mut turn] = [Spans::default(); 5];
    let mut patch = 0;
    let mut ended = None;
    let mut now = Millis(0);
    for (index, sample) in samples(GESTURE).enumerate() {
        if index == BEGINS {
            pipeline.begin_alignment(Arm::Unknown);
        }
        let before = pipeline.alignment_phase();
        now = now.plus(SAMPLE_PERIOD_MS);
        let sample = black_box(sample);
        let (_, instructions) = clock.span(|| black_box(pipeline.sample(now, sample)));
        let after = pipeline.alignment_phase();
        match (before, after, ended) {
            (AlignmentPhase::Waiting, AlignmentPhase::Waiting, _) => {
                patch += instructions;
                if (index - BEGINS) % PATCH == PATCH - 1 {
                    waiting.push(patch);
                    patch = 0;
                }
            }
            (AlignmentPhase::Waiting, AlignmentPhase::Aligned, _) => {
                end.push(instructions);
                ended = Some(index);
            }
            (_, _, Some(last)) if index < last + AGAIN => again.push(instructions),
            _ => {}
        }
    }
    assert!(
        pipeline.alignment() == Alignment::new(3, false),
        "not found"
    );
    // As after the gestures, and back.
    let means = black_box(GESTURE.map(|most| 32 * most as u32));
    let template = black_box(ramp());
    fit.push(clock.span(|| template.fit(Profile::new(means))).1);
    turn.push(clock.span(|| pipeline.set_alignment(Alignment::NONE)).1);
    [
        // The whole pipeline for a patch while gestures are waited for.
        ("align-patch", waiting),
        // The whole pipeline for the sample with which the alignment ends.
        ("align-end", end),
        // The whole pipeline for each sample after it, until the encoder has taken the window.
        ("align-again", again),
        // The fit of 16 placements alone.
        ("align-fit", fit),
        // Another order of the window's electrodes alone, and the encoder's memory cleared.
        ("align-turn", turn),
        // The whole pipeline for each sample while the model decides on the arm, the first and the last one included.
        ("align-arm", arm(encoder, model, &clock)),
    ]
}

/// Counts a decision between the arms.
///
/// # Panics
/// If there is none.
fn arm<E: Encode + Copy>(encoder: E, model: &Model<'_>, clock: &Clock) -> Spans {
    let mut memory = encoder.fresh();
    let mut pipeline = Pipeline::of_model(model, encoder, &mut memory).expect("good settings");
    pipeline.set_template(Some(about([400, 200, 0, -200, -300, -200, 0, 200])));
    pipeline.begin_alignment(Arm::Unknown);
    let mut newest = [0; DECISION];
    let mut now = Millis(0);
    for (index, sample) in samples(SYMMETRICAL).enumerate() {
        now = now.plus(SAMPLE_PERIOD_MS);
        let sample = black_box(sample);
        let (_, instructions) = clock.span(|| black_box(pipeline.sample(now, sample)));
        newest[index % DECISION] = instructions;
        if pipeline.alignment_phase() != AlignmentPhase::Waiting {
            break;
        }
    }
    let mut counts = Spans::default();
    for instructions in newest {
        counts.push(instructions);
    }
    // Between patches the encoder rests unless there is a decision.
    assert!(counts.mean() > 50_000, "no decision");
    counts
}
