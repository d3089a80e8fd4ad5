//! Training of the baselines.

mod batch;
mod learner;

use std::marker::PhantomData;

use burn::tensor::Device;

use self::batch::extract;
use self::learner::NetworkLearner;
use super::features::FeatureExtraction;
use super::networks::{EdTcn, LstmBaseline, Network};
use super::windows::WindowedCorpus;
use super::{Baseline, BaselineSettings};
use crate::job::JobError;
use execution::progress;
use presets::training::LrSchedule;
use recordings::corpus::Corpus;
use training::optimization::fit::{TrainConfig, Training, fit};
use training::run::context::RunContext;

struct Setup<'a> {
    training: &'a Corpus,
    /// Streams of the subjects that choose the checkpoint. The reference takes the last epoch instead; here one rule holds
    /// for all models.
    validation: &'a Corpus,
    settings: &'a BaselineSettings,
    seed: u64,
    /// Device with gradients.
    device: &'a Device,
    /// Place of the trained model; it is made from the streams of the run.
    place: Training<'a>,
}

/// Trains a baseline on the recordings and the split of a run.
pub(crate) fn train_baseline(
    context: &RunContext,
    baseline: Baseline,
    settings: &BaselineSettings,
) -> Result<(), JobError> {
    // The paper's baselines get the signal as the armband sends it.
    let config = context.config.without_normalization();
    let setup = Setup {
        training: &config.training(&context.library),
        validation: &config.validation(&context.library),
        settings,
        seed: context.config.preset.seed,
        device: &context.device,
        place: context.training(context.config.streams_lineage()),
    };
    train(baseline, &setup)
}

/// Trains one baseline and saves it in the run folder: its feature extraction and the network of the lowest validation loss.
fn train(baseline: Baseline, setup: &Setup<'_>) -> Result<(), JobError> {
    let (seed, device) = (setup.seed, setup.device);
    match baseline {
        Baseline::Lstm => train_network(baseline, setup, |of| LstmBaseline::new(seed, of, device)),
        Baseline::EdTcn => train_network(baseline, setup, |of| EdTcn::new(seed, of, device)),
    }
}

/// Trains the network that `network` makes for a number of classes.
fn train_network<N: Network>(
    baseline: Baseline,
    setup: &Setup<'_>,
    network: impl FnOnce(usize) -> N,
) -> Result<(), JobError> {
    let settings = setup.settings;
    let mut features = FeatureExtraction::new(baseline, settings.lstm_step);
    let layout = features.frame_layout();
    let windows = |corpus| WindowedCorpus::new(corpus, layout, settings.stride);
    let (training, validation) = (windows(setup.training), windows(setup.validation));
    let (of_training, of_validation) = (training.windows.len(), validation.windows.len());
    if of_training == 0 || of_validation == 0 {
        return Err(JobError::NoWindows {
            baseline: baseline.name(),
            training: of_training,
            validation: of_validation,
        });
    }
    progress::log(&format!(
        "{}: {of_training} training windows, {of_validation} validation windows",
        baseline.name(),
    ));
    if features.is_scaled() {
        let unscaled = extract(&features, &training, &training.windows);
        features = features.with_scaling(unscaled.iter().map(Vec::as_slice));
    }
    let (run, streams) = (setup.place.run, setup.place.made_from);
    let file = baseline.features_file();
    run.save_stamped(&file, streams, &features)?;
    // Read back from the file: the model is bound to exactly these numbers.
    let features: FeatureExtraction = run.load_stamped(&file, streams)?;
    let place = Training {
        made_from: features.lineage(streams),
        ..setup.place
    };
    let config = TrainConfig {
        epochs: settings.epochs,
        learning_rate: settings.learning_rate,
        lr_schedule: LrSchedule::Constant,
        weight_decay: settings.weight_decay,
        ema_decay: 0.0,
        seed: setup.seed,
    };
    let classes = setup.training.vocabulary.classes();
    let learner = NetworkLearner {
        baseline,
        features,
        training,
        validation,
        batch: settings.batch,
        device: setup.device,
        network: PhantomData,
    };
    fit(&learner, network(classes), config, &place)?;
    Ok(())
}

#[cfg(test)]
mod tests;
