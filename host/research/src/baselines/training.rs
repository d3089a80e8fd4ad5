//! Training of a baseline: one fit for LDA, epochs for the networks.

use std::marker::PhantomData;

use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::ed_tcn::EdTcnConfig;
use super::feature_extraction::FeatureExtraction;
use super::lda::Lda;
use super::lstm::LstmBaselineConfig;
use super::mlp::MlpConfig;
use super::network::Network;
use super::stream::{Window, Windows};
use super::trahgr::TraHgrConfig;
use super::{Baseline, BaselineSettings};
use myointent::dataset::corpus::Corpus;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::run::context::RunContext;
use myointent::training::dropout::Dropout;
use myointent::training::fit::{TrainConfig, fit};
use myointent::training::learner::{Learner, SHARDS, WeightedMetric};
use myointent::training::loss::cross_entropy;
use myointent::training::schedule::LrSchedule;
use myointent::training::tensor::best_class;
use myointent::training::tensor::read_back;

/// What a baseline is trained with.
pub struct Setup<'a> {
    /// Training streams.
    pub training: &'a Corpus,
    /// Streams of the subjects that choose the checkpoint. The reference takes the last epoch instead;
    /// here one rule holds for every model.
    pub validation: &'a Corpus,
    /// How.
    pub settings: &'a BaselineSettings,
    /// Seed of everything drawn.
    pub seed: u64,
    /// Device with gradients.
    pub device: &'a Device,
    /// Where the checkpoint goes.
    pub run: &'a RunFolder,
    /// Whether to go on after the last complete epoch.
    pub resume: bool,
    /// Ctrl-C.
    pub interrupt: &'a Interrupt,
}

/// Trains baselines on the recordings and the split of a run.
///
/// # Errors
/// When there is nothing to learn from, the folder cannot be written or the user interrupts.
pub fn train_all(
    context: &RunContext,
    baselines: &[Baseline],
    settings: &BaselineSettings,
) -> anyhow::Result<()> {
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

/// Trains one baseline and leaves it in the run's folder: its front end, and LDA's discriminants or
/// the network of the lowest validation loss.
///
/// # Errors
/// When no window teaches anything, the folder cannot be written or the user interrupts.
pub fn train(baseline: Baseline, setup: &Setup<'_>) -> anyhow::Result<()> {
    let front = FeatureExtraction::new(baseline, setup.settings.lstm_step);
    let windows_of = |corpus| Windows::of(corpus, front.output_steps(), setup.settings.stride);
    let training = windows_of(setup.training);
    let validation = windows_of(setup.validation);
    if training.windows.is_empty() || validation.windows.is_empty() {
        anyhow::bail!(
            "{} has {} windows to train on and {} to choose the checkpoint with; it needs both: give more labelled recordings",
            baseline.name(),
            training.windows.len(),
            validation.windows.len(),
        );
    }
    progress::log(&format!(
        "{}: {} windows to train on, {} to validate with",
        baseline.name(),
        training.windows.len(),
        validation.windows.len(),
    ));
    if !setup.resume {
        // A network must never be found beside the front end of another run.
        let state = format!("{}-state.json", baseline.file());
        let stale = [baseline.model_file(), baseline.features_file(), state];
        setup
            .run
            .remove_files(&stale.each_ref().map(String::as_str))?;
    }
    let front = match baseline {
        // Nothing of theirs is measured, and TraHGR's windows are long.
        Baseline::EdTcn | Baseline::TraHgr => front,
        Baseline::Lda | Baseline::Mlp | Baseline::Lstm => {
            let features = extract(&front, &training, &training.windows);
            front.scaled(features.iter().map(Vec::as_slice))
        }
    };
    setup.run.save_json(&baseline.features_file(), &front)?;
    let (classes, device) = (training.classes, setup.device);
    device.seed(setup.seed);
    let trainer = Trainer {
        baseline,
        front,
        training,
        validation,
    };
    match baseline {
        Baseline::Lda => trainer.fit_lda(setup),
        Baseline::Mlp => trainer.train(MlpConfig::default().init(classes, device), setup),
        Baseline::Lstm => trainer.train(LstmBaselineConfig::default().init(classes, device), setup),
        Baseline::EdTcn => trainer.train(EdTcnConfig::default().init(classes, device), setup),
        Baseline::TraHgr => trainer.train(TraHgrConfig::default().init(classes, device), setup),
    }
}

fn extract(front: &FeatureExtraction, windows_of: &Windows, windows: &[Window]) -> Vec<Vec<f32>> {
    let length = front.output_steps().window;
    windows
        .par_iter()
        .map(|window| front.extract(windows_of.streams[window.stream].window(window.end, length)))
        .collect()
}

/// Features with the class of the only step about each window.
fn examples(front: &FeatureExtraction, windows_of: &Windows) -> Vec<(Vec<f32>, usize)> {
    extract(front, windows_of, &windows_of.windows)
        .into_iter()
        .zip(&windows_of.windows)
        .filter_map(|(features, window)| {
            let labels = windows_of.streams[window.stream].labels(window.end, front.output_steps());
            labels[0].map(|intent| (features, intent.class()))
        })
        .collect()
}

/// A baseline and the windows that it learns from.
struct Trainer {
    baseline: Baseline,
    front: FeatureExtraction,
    training: Windows,
    validation: Windows,
}

impl Trainer {
    fn fit_lda(&self, setup: &Setup<'_>) -> anyhow::Result<()> {
        let lda = Lda::fit(
            &examples(&self.front, &self.training),
            self.training.classes,
        )?;
        let checks = examples(&self.front, &self.validation);
        let right = checks
            .iter()
            .filter(|(features, class)| best_class(&lda.scores(features)) == *class);
        progress::log(&format!(
            "{}: validation accuracy {:.4}",
            self.baseline.name(),
            right.count() as f64 / checks.len() as f64
        ));
        setup.run.save_json(&self.baseline.model_file(), &lda)?;
        Ok(())
    }

    fn train<N: Network>(self, network: N, setup: &Setup<'_>) -> anyhow::Result<()> {
        let settings = setup.settings;
        let train_config = TrainConfig {
            epochs: settings.epochs,
            learning_rate: settings.learning_rate,
            lr_schedule: LrSchedule::Constant,
            weight_decay: settings.weight_decay,
            ema_decay: 0.0,
            seed: setup.seed,
        };
        let learner = NetworkLearner {
            trainer: self,
            batch: settings.batch,
            device: setup.device,
            network: PhantomData,
        };
        fit(
            &learner,
            network,
            train_config,
            setup.run,
            setup.resume,
            setup.interrupt,
        )?;
        Ok(())
    }
}

/// A network's training, batch by batch.
struct NetworkLearner<'a, N> {
    trainer: Trainer,
    batch: usize,
    device: &'a Device,
    network: PhantomData<fn() -> N>,
}

/// Inputs of some windows and what should be answered.
struct Batch {
    input: Tensor<2>,
    label: Tensor<3, Int>,
    labelled: Tensor<2>,
    /// Labelled steps of the whole step's batch.
    steps: f64,
}

impl Batch {
    fn new(
        front: &FeatureExtraction,
        windows_of: &Windows,
        windows: &[Window],
        device: &Device,
    ) -> Self {
        let inputs = extract(front, windows_of, windows);
        let (rows, numbers) = (windows.len(), inputs[0].len());
        let labels: Vec<_> = windows
            .iter()
            .flat_map(|window| {
                windows_of.streams[window.stream].labels(window.end, front.output_steps())
            })
            .collect();
        let label: Vec<i32> = labels
            .iter()
            .map(|label| label.map_or(0, |intent| intent.class() as i32))
            .collect();
        let labelled: Vec<f32> = labels
            .iter()
            .map(|label| f32::from(u8::from(label.is_some())))
            .collect();
        let count = front.output_steps().count;
        Self {
            input: Tensor::from_data(TensorData::new(inputs.concat(), [rows, numbers]), device),
            label: Tensor::from_data(TensorData::new(label, [rows, count, 1]), device),
            steps: labelled.iter().map(|&one| f64::from(one)).sum(),
            labelled: Tensor::from_data(TensorData::new(labelled, [rows, count]), device),
        }
    }

    /// Cross entropy against the labels: the sum over labelled steps over the batch's number of them.
    fn loss(&self, logits: Tensor<3>) -> Tensor<1> {
        let weight = self.labelled.clone().unsqueeze_dim(2);
        cross_entropy(logits, self.label.clone(), weight, self.steps)
    }
}

impl<N: Network> Learner for NetworkLearner<'_, N> {
    type Model = N;
    type Item = Vec<Window>;
    type Shard = (Batch, ChaCha8Rng);

    fn name(&self) -> &'static str {
        self.trainer.baseline.file()
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.trainer.training.windows.clone();
        order.shuffle(rng);
        let mut items: Vec<Vec<Window>> = order.chunks(self.batch).map(<[_]>::to_vec).collect();
        // A few windows say little about a batch's mean: batch norm does without the last, short batch.
        if N::IN_ONE_PIECE && items.len() > 1 && !order.len().is_multiple_of(self.batch) {
            items.pop();
        }
        items
    }

    fn steps(&self) -> usize {
        self.trainer.training.windows.len().div_ceil(self.batch)
    }

    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let pieces = if N::IN_ONE_PIECE { 1 } else { SHARDS };
        let mut shards: Vec<Self::Shard> = item
            .chunks(item.len().div_ceil(pieces))
            .map(|part| {
                let batch = Batch::new(
                    &self.trainer.front,
                    &self.trainer.training,
                    part,
                    self.device,
                );
                (batch, ChaCha8Rng::from_rng(rng))
            })
            .collect();
        // Means are over the whole batch, as if it had been computed in one piece.
        let steps = shards.iter().map(|(batch, _)| batch.steps).sum();
        for (batch, _) in &mut shards {
            batch.steps = steps;
        }
        shards
    }

    fn loss(&self, model: &N, (batch, rng): Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>) {
        let mut losses = model
            .forward(batch.input.clone(), &mut Dropout::from(rng))
            .into_iter()
            .map(|logits| batch.loss(logits));
        let main = losses.next().expect("a network has a head");
        let part = WeightedMetric {
            name: "label",
            mean: f64::from(read_back(main.clone())[0]),
            weight: batch.steps,
        };
        (losses.fold(main, |sum, loss| sum + loss), vec![part])
    }

    fn validate(&self, model: &N) -> (f64, Vec<WeightedMetric>) {
        let device = self.device.clone().inner();
        let (mut loss, mut right, mut steps) = (0.0, 0.0, 0.0);
        for windows in self.trainer.validation.windows.chunks(self.batch) {
            let batch = Batch::new(
                &self.trainer.front,
                &self.trainer.validation,
                windows,
                &device,
            );
            let logits = model
                .forward(batch.input.clone(), &mut Dropout::off())
                .remove(0);
            let hits = logits
                .clone()
                .argmax(2)
                .equal(batch.label.clone())
                .float()
                .squeeze_dim::<2>(2)
                * batch.labelled.clone();
            right += f64::from(read_back(hits.sum())[0]);
            loss += f64::from(read_back(batch.loss(logits))[0]) * batch.steps;
            steps += batch.steps;
        }
        let part = |name, sum: f64| WeightedMetric {
            name,
            mean: sum / f64::max(steps, 1.0),
            weight: 1.0,
        };
        let loss = part("label", loss);
        (loss.mean, vec![loss, part("accuracy", right)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::inference::TrainedBaseline;
    use myointent::dataset::corpus::Stream;
    use rand::RngExt;
    use shared::intent::{Intent, Vocabulary};
    use shared::units::{PATCH, Sample};

    /// Each intent is loud on two channels of its own, for 3 to 6 s.
    fn corpus(seed: u64) -> Corpus {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut raw: Vec<Sample> = Vec::new();
        let mut labels = Vec::new();
        for hold in 0..12 {
            let intent = Intent::ALL[hold % 3];
            for _ in 0..rng.random_range(600..1200) {
                raw.push(std::array::from_fn(|channel| {
                    let loud = channel / 2 == intent.class();
                    let size = if loud { 90 } else { 8 };
                    rng.random_range(-size..=size)
                }));
                labels.push(Some(intent));
            }
        }
        Corpus {
            vocabulary: Vocabulary::Three,
            streams: vec![Stream::new(raw, labels)],
        }
    }

    /// Trains on one synthetic stream and returns the share of another one's patches named rightly.
    fn accuracy_after(baseline: Baseline, settings: &BaselineSettings) -> f64 {
        let (training, unseen) = (corpus(1), corpus(2));
        let folder = tempfile::tempdir().unwrap();
        let run = RunFolder::open(folder.path()).unwrap();
        let device = Device::default().autodiff();
        let setup = Setup {
            training: &training,
            validation: &unseen,
            settings,
            seed: 42,
            device: &device,
            run: &run,
            resume: false,
            interrupt: &Interrupt::default(),
        };
        train(baseline, &setup).unwrap();
        let trained = TrainedBaseline::load(baseline, &run, 3, &device.inner())
            .unwrap()
            .unwrap();
        let stream = &unseen.streams[0];
        let rows = trained.logits(&stream.raw, &stream.emg);
        assert_eq!(rows.len(), stream.raw.len() / PATCH);
        let right = rows
            .iter()
            .enumerate()
            .filter(|(patch, rows)| {
                let label = stream.labels[patch * PATCH + PATCH - 1];
                label.is_some_and(|intent| intent.class() == best_class(&rows[0][..3]))
            })
            .count();
        right as f64 / rows.len() as f64
    }

    fn quick(epochs: usize, learning_rate: f64) -> BaselineSettings {
        BaselineSettings {
            stride: 60,
            epochs,
            batch: 16,
            learning_rate,
            lstm_step: 50,
            ..BaselineSettings::default()
        }
    }

    // A window of 3 s cannot follow a change at once, and what was loud before still fills most of it: no
    // baseline names every patch rightly. Chance is 0.33, and after so few steps all have reached 0.8.

    #[test]
    fn lda_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Baseline::Lda, &quick(1, 0.0));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_mlp_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Baseline::Mlp, &quick(2, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_lstm_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Baseline::Lstm, &quick(1, 2e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_ed_tcn_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Baseline::EdTcn, &quick(2, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn trahgr_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Baseline::TraHgr, &quick(3, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }
}
