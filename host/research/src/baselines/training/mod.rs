//! Training of the baselines.

mod batch;
mod data;
mod learner;

use burn::tensor::Device;

use self::data::TrainingData;
use super::Baseline;
use super::features::FeatureExtraction;
use super::networks::{EdTcnConfig, LstmBaselineConfig};
use super::settings::BaselineSettings;
use execution::run_folder::RunError;
use recordings::corpus::Corpus;
use training::optimization::fit::Training;
use training::optimization::initial;
use training::run::context::RunContext;

/// Why a baseline cannot be trained.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TrainingError {
    #[error(
        "{baseline} has {training} training windows and {validation} validation windows; it needs both: give more labelled recordings"
    )]
    NoWindows {
        baseline: &'static str,
        training: usize,
        validation: usize,
    },
    #[error(transparent)]
    Run(#[from] RunError),
}

impl TrainingError {
    /// Whether the user interrupted.
    pub(crate) const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Run(RunError::Interrupted { .. }))
    }
}

/// Data and settings of a training.
struct Setup<'a> {
    /// Training streams.
    training: &'a Corpus,
    /// Streams of the subjects that choose the checkpoint. The reference takes the last epoch instead; here one rule holds
    /// for all models.
    validation: &'a Corpus,
    /// Training settings.
    settings: &'a BaselineSettings,
    /// Seed of all random draws.
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
) -> Result<(), TrainingError> {
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
fn train(baseline: Baseline, setup: &Setup<'_>) -> Result<(), TrainingError> {
    let mut data = TrainingData::new(baseline, setup)?;
    data.fit_scaling();
    let (run, streams) = (setup.place.run, setup.place.made_from);
    let file = baseline.features_file();
    run.save_stamped(&file, streams, data.features())?;
    // Read back from the file: the model is bound to exactly these numbers.
    let features = run.load_stamped::<FeatureExtraction>(&file, streams)?;
    let place = &Training {
        made_from: features.content.lineage(streams),
        ..setup.place
    };
    let (classes, device) = (data.classes(), setup.device);
    match baseline {
        Baseline::Lstm => {
            let network = initial(setup.seed, device, || {
                LstmBaselineConfig::default().init(classes, device)
            });
            learner::fit(data, network, setup, place)
        }
        Baseline::EdTcn => {
            let network = initial(setup.seed, device, || {
                EdTcnConfig::default().init(classes, device)
            });
            learner::fit(data, network, setup, place)
        }
    }
}

#[cfg(test)]
mod tests;
