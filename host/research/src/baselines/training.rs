//! Training of a peer: one fit for LDA, epochs for the networks.

use std::marker::PhantomData;

use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::ed_tcn::EdTcnConfig;
use super::front_end::FrontEnd;
use super::lda::Lda;
use super::lstm::LstmPeerConfig;
use super::mlp::MlpConfig;
use super::network::Network;
use super::stream::{Material, Window};
use super::trahgr::TraHgrConfig;
use super::{Peer, PeerSettings};
use myointent::dataset::corpus::{Corpus};
use myointent::training::tensor::best_class;
use myointent::training::tensor::read_back;
use myointent::training::fit::{Learner, Pace, Part, SHARDS, fit};
use myointent::execution::interrupt::Interrupt;
use myointent::training::loss::cross_entropy;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::training::schedule::Course;
use myointent::training::dropout::Dropout;

/// What a peer is trained with.
pub struct Lesson<'a> {
    /// Training streams.
    pub training: &'a Corpus,
    /// Streams of the subjects that choose the checkpoint. The reference takes the last epoch instead;
    /// here one rule holds for every model.
    pub validation: &'a Corpus,
    /// How.
    pub settings: &'a PeerSettings,
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

/// Trains one peer and leaves it in the run's folder: its front end, and LDA's discriminants or
/// the network of the lowest validation loss.
///
/// # Errors
/// When no window teaches anything, the folder cannot be written or the user interrupts.
pub fn train(peer: Peer, lesson: &Lesson<'_>) -> anyhow::Result<()> {
    let front = FrontEnd::new(peer, lesson.settings.lstm_step);
    let material = |corpus| Material::of(corpus, front.answers(), lesson.settings.stride);
    let training = material(lesson.training);
    let validation = material(lesson.validation);
    if training.windows.is_empty() || validation.windows.is_empty() {
        anyhow::bail!(
            "{} has {} windows to train on and {} to choose the checkpoint with; it needs both: give more labelled recordings",
            peer.name(),
            training.windows.len(),
            validation.windows.len(),
        );
    }
    progress::say(&format!(
        "{}: {} windows to train on, {} to validate with",
        peer.name(),
        training.windows.len(),
        validation.windows.len(),
    ));
    if !lesson.resume {
        // A network must never be found beside the front end of another run.
        let state = format!("{}-state.json", peer.file());
        let stale = [peer.model_file(), peer.front_end_file(), state];
        lesson.run.forget(&stale.each_ref().map(String::as_str))?;
    }
    let front = match peer {
        // Nothing of theirs is measured, and TraHGR's windows are long.
        Peer::EdTcn | Peer::TraHgr => front,
        Peer::Lda | Peer::Mlp | Peer::Lstm => {
            let heard = hear(&front, &training, &training.windows);
            front.scaled(heard.iter().map(Vec::as_slice))
        }
    };
    lesson.run.save_json(&peer.front_end_file(), &front)?;
    let (classes, device) = (training.classes, lesson.device);
    device.seed(lesson.seed);
    let class = Class {
        peer,
        front,
        training,
        validation,
    };
    match peer {
        Peer::Lda => class.fit_lda(lesson),
        Peer::Mlp => class.teach(MlpConfig::default().init(classes, device), lesson),
        Peer::Lstm => class.teach(LstmPeerConfig::default().init(classes, device), lesson),
        Peer::EdTcn => class.teach(EdTcnConfig::default().init(classes, device), lesson),
        Peer::TraHgr => class.teach(TraHgrConfig::default().init(classes, device), lesson),
    }
}

fn hear(front: &FrontEnd, material: &Material, windows: &[Window]) -> Vec<Vec<f32>> {
    let length = front.answers().window;
    windows
        .par_iter()
        .map(|window| front.hear(material.streams[window.stream].heard(window.end, length)))
        .collect()
}

/// Features with the class of the only answer about each window.
fn examples(front: &FrontEnd, material: &Material) -> Vec<(Vec<f32>, usize)> {
    hear(front, material, &material.windows)
        .into_iter()
        .zip(&material.windows)
        .filter_map(|(features, window)| {
            let labels = material.streams[window.stream].labels(window.end, front.answers());
            labels[0].map(|intent| (features, intent.class()))
        })
        .collect()
}

/// A peer and the windows that it learns from.
struct Class {
    peer: Peer,
    front: FrontEnd,
    training: Material,
    validation: Material,
}

impl Class {
    fn fit_lda(&self, lesson: &Lesson<'_>) -> anyhow::Result<()> {
        let lda = Lda::fit(
            &examples(&self.front, &self.training),
            self.training.classes,
        )?;
        let checks = examples(&self.front, &self.validation);
        let right = checks
            .iter()
            .filter(|(features, class)| best_class(&lda.scores(features)) == *class);
        progress::say(&format!(
            "{}: validation accuracy {:.4}",
            self.peer.name(),
            right.count() as f64 / checks.len() as f64
        ));
        lesson.run.save_json(&self.peer.model_file(), &lda)?;
        Ok(())
    }

    fn teach<N: Network>(self, network: N, lesson: &Lesson<'_>) -> anyhow::Result<()> {
        let settings = lesson.settings;
        let pace = Pace {
            epochs: settings.epochs,
            learning_rate: settings.learning_rate,
            course: Course::Constant,
            weight_decay: settings.weight_decay,
            average: 0.0,
            seed: lesson.seed,
        };
        let learner = PeerLearner {
            class: self,
            batch: settings.batch,
            device: lesson.device,
            network: PhantomData,
        };
        fit(
            &learner,
            network,
            pace,
            lesson.run,
            lesson.resume,
            lesson.interrupt,
        )?;
        Ok(())
    }
}

/// A network's training, batch by batch.
struct PeerLearner<'a, N> {
    class: Class,
    batch: usize,
    device: &'a Device,
    network: PhantomData<fn() -> N>,
}

/// Inputs of some windows and what should be answered.
struct Batch {
    input: Tensor<2>,
    label: Tensor<3, Int>,
    labelled: Tensor<2>,
    /// Labelled answers of the whole step's batch.
    answers: f64,
}

impl Batch {
    fn new(front: &FrontEnd, material: &Material, windows: &[Window], device: &Device) -> Self {
        let inputs = hear(front, material, windows);
        let (rows, numbers) = (windows.len(), inputs[0].len());
        let labels: Vec<_> = windows
            .iter()
            .flat_map(|window| material.streams[window.stream].labels(window.end, front.answers()))
            .collect();
        let label: Vec<i32> = labels
            .iter()
            .map(|label| label.map_or(0, |intent| intent.class() as i32))
            .collect();
        let labelled: Vec<f32> = labels
            .iter()
            .map(|label| f32::from(u8::from(label.is_some())))
            .collect();
        let count = front.answers().count;
        Self {
            input: Tensor::from_data(TensorData::new(inputs.concat(), [rows, numbers]), device),
            label: Tensor::from_data(TensorData::new(label, [rows, count, 1]), device),
            answers: labelled.iter().map(|&one| f64::from(one)).sum(),
            labelled: Tensor::from_data(TensorData::new(labelled, [rows, count]), device),
        }
    }

    /// Cross entropy against the labels: the sum over labelled answers over the batch's number of them.
    fn loss(&self, logits: Tensor<3>) -> Tensor<1> {
        let weight = self.labelled.clone().unsqueeze_dim(2);
        cross_entropy(logits, self.label.clone(), weight, self.answers)
    }
}

impl<N: Network> Learner for PeerLearner<'_, N> {
    type Model = N;
    type Item = Vec<Window>;
    type Shard = (Batch, ChaCha8Rng);

    fn name(&self) -> &'static str {
        self.class.peer.file()
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.class.training.windows.clone();
        order.shuffle(rng);
        let mut items: Vec<Vec<Window>> = order.chunks(self.batch).map(<[_]>::to_vec).collect();
        // A few windows say little about a batch's mean: batch norm does without the last, short batch.
        if N::IN_ONE_PIECE && items.len() > 1 && !order.len().is_multiple_of(self.batch) {
            items.pop();
        }
        items
    }

    fn steps(&self) -> usize {
        self.class.training.windows.len().div_ceil(self.batch)
    }

    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let pieces = if N::IN_ONE_PIECE { 1 } else { SHARDS };
        let mut shards: Vec<Self::Shard> = item
            .chunks(item.len().div_ceil(pieces))
            .map(|part| {
                let batch = Batch::new(&self.class.front, &self.class.training, part, self.device);
                (batch, ChaCha8Rng::from_rng(rng))
            })
            .collect();
        // Means are over the whole batch, as if it had been computed in one piece.
        let answers = shards.iter().map(|(batch, _)| batch.answers).sum();
        for (batch, _) in &mut shards {
            batch.answers = answers;
        }
        shards
    }

    fn loss(&self, model: &N, (batch, rng): Self::Shard) -> (Tensor<1>, Vec<Part>) {
        let mut losses = model
            .forward(batch.input.clone(), &mut Dropout::from(rng))
            .into_iter()
            .map(|logits| batch.loss(logits));
        let said = losses.next().expect("a network has a head");
        let part = Part {
            name: "label",
            mean: f64::from(read_back(said.clone())[0]),
            weight: batch.answers,
        };
        (losses.fold(said, |sum, loss| sum + loss), vec![part])
    }

    fn validate(&self, model: &N) -> (f64, Vec<Part>) {
        let device = self.device.clone().inner();
        let (mut loss, mut right, mut answers) = (0.0, 0.0, 0.0);
        for windows in self.class.validation.windows.chunks(self.batch) {
            let batch = Batch::new(&self.class.front, &self.class.validation, windows, &device);
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
            loss += f64::from(read_back(batch.loss(logits))[0]) * batch.answers;
            answers += batch.answers;
        }
        let part = |name, sum: f64| Part {
            name,
            mean: sum / f64::max(answers, 1.0),
            weight: 1.0,
        };
        let loss = part("label", loss);
        (loss.mean, vec![loss, part("accuracy", right)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use myointent::dataset::corpus::{Stream};
    use crate::baselines::evaluation::TrainedPeer;
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

    /// Trains on one made-up stream and returns the share of another one's patches named rightly.
    fn accuracy_after(peer: Peer, settings: &PeerSettings) -> f64 {
        let (training, unseen) = (corpus(1), corpus(2));
        let folder = tempfile::tempdir().unwrap();
        let run = RunFolder::open(folder.path()).unwrap();
        let device = Device::default().autodiff();
        let lesson = Lesson {
            training: &training,
            validation: &unseen,
            settings,
            seed: 42,
            device: &device,
            run: &run,
            resume: false,
            interrupt: &Interrupt::default(),
        };
        train(peer, &lesson).unwrap();
        let trained = TrainedPeer::load(peer, &run, 3, &device.inner())
            .unwrap()
            .unwrap();
        let stream = &unseen.streams[0];
        let rows = trained.rows(&stream.raw, &stream.emg);
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

    fn quick(epochs: usize, learning_rate: f64) -> PeerSettings {
        PeerSettings {
            stride: 60,
            epochs,
            batch: 16,
            learning_rate,
            lstm_step: 50,
            ..PeerSettings::default()
        }
    }

    // A window of 3 s cannot follow a change at once, and what was loud before still fills most of it: no
    // peer names every patch rightly. Chance is 0.33, and after so few steps all have reached 0.8.

    #[test]
    fn lda_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Peer::Lda, &quick(1, 0.0));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_mlp_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Peer::Mlp, &quick(2, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_lstm_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Peer::Lstm, &quick(1, 2e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn the_ed_tcn_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Peer::EdTcn, &quick(2, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }

    #[test]
    fn trahgr_learns_which_channels_are_loud() {
        let accuracy = accuracy_after(Peer::TraHgr, &quick(3, 1e-3));
        assert!(accuracy > 0.7, "{accuracy}");
    }
}
