//! Tests that no logits depend on samples after their patch.

use crate::student::model::Student;
use crate::teacher::model::Teacher;
use burn::tensor::Device;
use shared::intent::Vocabulary;
use shared::model::LookBackLogits;
use shared::model::dimensions::{Companding, Dimensions};
use shared::model::file::Model;
use shared::model::file::random::random_model;
use shared::units::{CHANNELS, CleanSample, PATCH};

use super::{student_logits, teacher_logits};
use crate::student::model::StudentConfig;
use crate::teacher::model::TeacherConfig;
use evaluation::inference::integer_logits;

/// Samples of the recording; not a multiple of a patch.
const SAMPLES: usize = 345;

/// EMG without repetition; the values from sample `changed` on differ.
fn recording(changed: usize) -> Vec<CleanSample> {
    (0..SAMPLES)
        .map(|at| {
            std::array::from_fn::<u8, CHANNELS, _>(|channel| {
                let value = (at * 37 + channel * 11 + at * at / 7) % 129;
                (if at < changed { value } else { 128 - value }) as u8
            })
        })
        .collect()
}

/// Checks causality: after a change of all samples from a patch on, the logits up to it must stay the same. Later logits must
/// change, or the test would be void.
fn is_causal(logits: impl Fn(&[CleanSample]) -> Vec<LookBackLogits>) {
    let whole = logits(&recording(SAMPLES));
    assert_eq!(whole.len(), SAMPLES / PATCH);
    for patch in [0, 1, 2, 5, 9, 10, 20, 33] {
        let known = patch + 1;
        let changed = logits(&recording(known * PATCH));
        let differs = whole.iter().zip(&changed).position(|(a, b)| a != b);
        assert!(
            differs.is_none_or(|first| first >= known),
            "logits of patch {differs:?} change with samples after patch {patch}"
        );
        if known < whole.len() {
            assert_eq!(differs, Some(known));
        }
    }
}

#[test]
fn logits_of_the_teacher_do_not_change_with_later_samples() {
    let device = Device::default();
    let config = TeacherConfig {
        window: 600,
        patch: 20,
        companding: Companding::SquareRoot,
        d_model: 16,
        heads: 2,
        layers: 1,
        feed_forward: 32,
        dropout: 0.0,
        attention_dropout: 0.0,
    };
    let model = Teacher::new(1, &config, 3, &device);
    is_causal(|emg| teacher_logits(&model, config.window_shape(), emg, &device));
}

#[test]
fn logits_of_the_float_student_do_not_change_with_later_samples() {
    let device = Device::default();
    let config = StudentConfig {
        d_model: 16,
        heads: 2,
        layers: 2,
        span: 27,
        companding: Companding::SquareRoot,
        board: true,
    };
    let model = Student::new(1, &config, 3, false, &device);
    is_causal(|emg| student_logits(&model, emg, &device));
}

#[test]
fn logits_of_the_integer_student_do_not_change_with_later_samples() {
    let dimensions = Dimensions::new(Vocabulary::Three, 64, 2, 27);
    let bytes = random_model(dimensions, 5).to_bytes().unwrap();
    let model = Model::parse(&bytes).unwrap();
    is_causal(|emg| integer_logits(&model, emg).unwrap());
}
