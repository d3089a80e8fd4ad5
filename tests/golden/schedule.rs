//! Learning rate of the reference at each step: golden/lr_schedule.json.

use burn::tensor::Device;
use myointent_tests::golden;
use presets::Preset;
use presets::masking::Task;
use presets::training::{LearningRate, LrSchedule};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use recordings::corpus::{Corpus, Stream};
use shared::intent::{Intent, Vocabulary};
use shared::units::WINDOW;
use training::optimization::learner::Learner as _;
use training::teacher::learner::TeacherLearner;
use training::teacher::window::WindowShape;

use crate::files::json;

/// Window shape of the paper.
const SHAPE: WindowShape = WindowShape {
    window: WINDOW,
    patch: 1,
};

/// Builds a corpus of `windows` windows, one sample apart.
fn corpus(windows: usize) -> Corpus {
    let samples = WINDOW + windows - 1;
    Corpus {
        vocabulary: Vocabulary::Three,
        other: false,
        streams: vec![Stream::new(
            vec![[0; 8]; samples],
            vec![Some(Intent::Relax); samples],
        )],
    }
}

#[test]
fn every_step_has_the_references_rate() {
    let golden = golden();
    let golden = json(&golden.join("lr_schedule.json"));
    let mut training = Preset::find("paper").unwrap().teacher_training;
    assert_eq!(golden["base_lr"], training.learning_rate);
    let LrSchedule::WarmUp(share) = training.lr_schedule else {
        panic!("the paper warms up")
    };
    assert_eq!(golden["warmup_ratio"], share);
    let mut compared = 0;
    // The other decays are options that no script of the paper uses.
    for case in golden["schedules"].as_array().unwrap() {
        if case["decay"] != "linear" {
            continue;
        }
        let number = |key: &str| case[key].as_u64().unwrap() as usize;
        training.stride = 1;
        training.tasks = vec![Task::Intent];
        (training.batch, training.epochs) = (number("batch"), number("epochs"));
        let corpus = corpus(number("samples"));
        let device = Device::default();
        let learner = TeacherLearner::new(SHAPE, &corpus, &corpus, &training, 0, &device);

        let total = training.epochs * learner.steps();
        assert_eq!(total, number("total_steps"), "{case}");
        let taken = learner.epoch(&mut ChaCha8Rng::seed_from_u64(0)).len();
        assert_eq!(
            training.epochs * taken,
            number("optimizer_steps_really_taken"),
            "{case}"
        );

        let schedule = LearningRate::new(training.learning_rate, training.lr_schedule, total);
        for (step, expected) in case["lr_used_at_step"].as_object().unwrap() {
            let found = schedule.rate(step.parse().unwrap());
            let expected = expected.as_f64().unwrap();
            // The reference rounds a factor first: the last bits differ.
            let off = (found - expected).abs();
            assert!(
                off < 1e-12 * training.learning_rate,
                "{step}: {found}, {expected}"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 35);
}
