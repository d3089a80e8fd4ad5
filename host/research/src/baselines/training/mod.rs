//! Training of the baselines: a closed-form fit for LDA, epochs of optimizer steps for the networks.

mod batch;
mod data;
mod error;
mod learner;

use burn::tensor::Device;

use self::data::TrainingData;
use super::Baseline;
use super::lda::Lda;
use super::networks::{EdTcnConfig, LstmBaselineConfig, MlpConfig, TraHgrConfig};
use super::settings::BaselineSettings;
use myointent::dataset::corpus::Corpus;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::run::context::RunContext;
use myointent::training::tensor::best_class;

pub(crate) use error::TrainingError;

/// What a baseline is trained with.
struct Setup<'a> {
    /// Training streams.
    training: &'a Corpus,
    /// Streams of the subjects that choose the checkpoint. The reference takes the last epoch instead;
    /// here one rule holds for every model.
    validation: &'a Corpus,
    /// Training settings.
    settings: &'a BaselineSettings,
    /// Seed of all random draws.
    seed: u64,
    /// Device with gradients.
    device: &'a Device,
    /// Where the model is saved.
    run: &'a RunFolder,
    /// Whether to continue after the last complete epoch.
    resume: bool,
    /// Set by Ctrl-C.
    interrupt: &'a Interrupt,
}

/// Trains baselines on the recordings and the split of a run.
///
/// # Errors
/// When no window has a target, the folder cannot be written or the user interrupts.
pub(crate) fn train_all(
    context: &RunContext,
    baselines: &[Baseline],
    settings: &BaselineSettings,
) -> Result<(), TrainingError> {
    let setup = Setup {
        training: &context.config.training(&context.library),
        validation: &context.config.validation(&context.library),
        settings,
        seed: context.config.preset.seed,
        device: &context.device,
        run: &context.folder,
        resume: context.resume,
        interrupt: &context.interrupt,
    };
    baselines
        .iter()
        .try_for_each(|&baseline| train(baseline, &setup))
}

/// Trains one baseline and saves it in the run folder: its feature extraction, and LDA's discriminants or
/// the network of the lowest validation loss.
fn train(baseline: Baseline, setup: &Setup<'_>) -> Result<(), TrainingError> {
    let mut data = TrainingData::new(baseline, setup)?;
    if !setup.resume {
        // A model must never lie beside the feature extraction of another run.
        let state = format!("{}-state.json", baseline.file_stem());
        let stale = [baseline.model_file(), baseline.features_file(), state];
        setup
            .run
            .remove_files(&stale.each_ref().map(String::as_str))?;
    }
    data.fit_scaling();
    setup
        .run
        .save_json(&baseline.features_file(), data.features())?;
    let (classes, device) = (data.classes(), setup.device);
    device.seed(setup.seed);
    match baseline {
        Baseline::Lda => fit_lda(&data, setup),
        Baseline::Mlp => learner::fit(data, MlpConfig::default().init(classes, device), setup),
        Baseline::Lstm => learner::fit(
            data,
            LstmBaselineConfig::default().init(classes, device),
            setup,
        ),
        Baseline::EdTcn => learner::fit(data, EdTcnConfig::default().init(classes, device), setup),
        Baseline::TraHgr => {
            learner::fit(data, TraHgrConfig::default().init(classes, device), setup)
        }
    }
}

fn fit_lda(data: &TrainingData, setup: &Setup<'_>) -> Result<(), TrainingError> {
    let lda = Lda::fit(&data.training_examples(), data.classes())?;
    let validation = data.validation_examples();
    let correct = validation
        .iter()
        .filter(|(features, class)| best_class(&lda.scores(features)) == *class);
    progress::log(&format!(
        "{}: validation accuracy {:.4}",
        Baseline::Lda.name(),
        correct.count() as f64 / validation.len() as f64
    ));
    setup.run.save_json(&Baseline::Lda.model_file(), &lda)?;
    Ok(())
}

#[cfg(test)]
mod tests;
