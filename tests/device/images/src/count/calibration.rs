//! Instructions of a calibration: a patch of either round, and the sample with which the last layer is solved.

use core::hint::black_box;

use shared::calibration::{Memory, Shown};
use shared::intent::Intent;
use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::Pipeline;
use shared::stream::alignment::Arm;
use shared::uart_line::calibration::CalibrationState;
use shared::units::{CHANNELS, Millis, PATCH, SAMPLE_PERIOD_MS, WINDOW};

use crate::alignment::{AGAIN, GESTURE, REST, noise};
use crate::spans::{Clock, Spans};

/// Samples of both rounds of a model of six classes, and more.
const MOST: usize = 16_000;

/// Counts one calibration of a wearer who does what is asked for, each gesture with other electrodes; by the names of
/// its parts.
///
/// # Panics
/// If it does not come to its end: then something else was counted.
pub fn count<E: Encode + Copy>(
    encoder: E,
    model: &Model<'_>,
    memory: &mut Memory,
) -> [(&'static str, Spans); 3] {
    let mut state = encoder.fresh();
    let mut pipeline = Pipeline::of_model(model, encoder, &mut state).expect("good settings");
    // Without it nothing is aligned.
    pipeline.set_template(None);
    pipeline.lend(memory);
    let clock = Clock::new();
    let [mut teaching, mut judging, mut solve] = [Spans::default(); 3];
    let mut noise = noise();
    let (mut state, mut cue) = (CalibrationState::Idle, None);
    let (mut patch, mut solved, mut now) = (0, 0, Millis(0));
    for index in 0..MOST {
        // With the next sample a patch begins, as the median lags one.
        if index == WINDOW + 1 {
            let _ = pipeline
                .begin_calibration(now, false, Arm::Unknown)
                .expect("memory");
        }
        let turn = match cue {
            Some(Shown::Intent(intent)) if intent != Intent::Relax => {
                Some(3 * intent.class() % CHANNELS)
            }
            _ => None,
        };
        let mut sample = GESTURE.map(|most| noise(if turn.is_some() { most } else { REST }) as i8);
        sample.rotate_left(turn.unwrap_or(0));
        now = now.plus(SAMPLE_PERIOD_MS);
        let sample = black_box(sample);
        let (_, instructions) = clock.span(|| black_box(pipeline.sample(now, sample)));
        patch += instructions;
        let before = state;
        if let Some(report) = pipeline.take_calibration_report() {
            (state, cue) = (report.state, report.cue);
        }
        use CalibrationState::{Judging, Keeping, Teaching};
        match (before, state) {
            (Teaching, Judging) | (Judging, Keeping) => {
                solved = index;
                solve.push(instructions);
            }
            (Teaching, _) if index % PATCH == 0 => teaching.push(patch),
            (Judging, _) if index % PATCH == 0 && index > solved + AGAIN + PATCH => {
                judging.push(patch);
            }
            _ => {}
        }
        if index % PATCH == 0 {
            patch = 0;
        }
    }
    let ends = [CalibrationState::Keeping, CalibrationState::Worse];
    assert!(ends.contains(&state), "{}", state.name());
    [
        // The whole pipeline for a patch of round one.
        ("calibrate-teach", teaching),
        // The whole pipeline for a patch of round two, once the encoder has taken the window again.
        ("calibrate-judge", judging),
        // The whole pipeline for a sample with which a round ends: the solve, and a patch.
        ("calibrate-solve", solve),
    ]
}
