//! Tests that each baseline learns a simple synthetic task.

use super::*;
use crate::baselines::inference::TrainedBaseline;
use execution::fingerprint::Fingerprint;
use execution::interrupt::Interrupt;
use execution::run_folder::RunFolder;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use recordings::corpus::Stream;
use shared::intent::{Intent, Vocabulary};
use shared::units::{PATCH, Sample};
use training::optimization::best_class;
use training::optimization::fit::CHECKPOINT_EVERY;

/// Twelve holds of 3 to 6 s. Each intent has a high amplitude on two channels of its own.
fn corpus(seed: u64) -> Corpus {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut raw: Vec<Sample> = Vec::new();
    let mut labels = Vec::new();
    for hold in 0..12 {
        let intent = Intent::ALL[hold % 3];
        for _ in 0..rng.random_range(600..1200) {
            raw.push(std::array::from_fn(|channel| {
                let active = channel / 2 == intent.class();
                let amplitude = if active { 90 } else { 8 };
                rng.random_range(-amplitude..=amplitude)
            }));
            labels.push(Some(intent));
        }
    }
    Corpus {
        vocabulary: Vocabulary::Three,
        other: false,
        streams: vec![Stream::new(raw, labels)],
    }
}

/// Trains on one synthetic stream and returns the share of another stream's patches that are classified correctly.
fn accuracy_after(baseline: Baseline, settings: &BaselineSettings) -> f64 {
    let (training, unseen) = (corpus(1), corpus(2));
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    let device = Device::default().autodiff();
    let streams = Fingerprint::of(&"synthetic");
    let setup = Setup {
        training: &training,
        validation: &unseen,
        settings,
        seed: 42,
        device: &device,
        place: Training {
            run: &run,
            made_from: streams,
            resume: false,
            checkpoint_every: CHECKPOINT_EVERY,
            interrupt: &Interrupt::default(),
        },
    };
    train(baseline, &setup).unwrap();
    let trained = TrainedBaseline::load(baseline, &run, streams, 3, &device.inner()).unwrap();
    let stream = &unseen.streams[0];
    let rows = trained.logits(&stream.raw);
    assert_eq!(rows.len(), stream.raw.len() / PATCH);
    let correct = rows
        .iter()
        .enumerate()
        .filter(|(patch, rows)| {
            let label = stream.labels[patch * PATCH + PATCH - 1];
            label.is_some_and(|intent| intent.class() == best_class(&rows[0][..3]))
        })
        .count();
    correct as f64 / rows.len() as f64
}

fn settings(epochs: usize, learning_rate: f64) -> BaselineSettings {
    BaselineSettings {
        stride: 60,
        epochs,
        batch: 16,
        learning_rate,
        lstm_step: 50,
        ..BaselineSettings::default()
    }
}

// After a transition the window of 3 s still holds mostly the previous intent, so no baseline reaches an
// accuracy of 1. Chance is 0.33; with this seed the accuracies are 0.79 (ED-TCN) to 0.95 (LSTM).

#[test]
fn the_lstm_learns_which_channels_are_active() {
    let accuracy = accuracy_after(Baseline::Lstm, &settings(1, 2e-3));
    assert!(accuracy > 0.75, "{accuracy}");
}

#[test]
fn the_ed_tcn_learns_which_channels_are_active() {
    let accuracy = accuracy_after(Baseline::EdTcn, &settings(2, 1e-3));
    assert!(accuracy > 0.75, "{accuracy}");
}
