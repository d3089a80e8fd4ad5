//! What the trained peers of a run's folder say at every patch.

use burn::tensor::{Device, Tensor, TensorData};
use shared::units::{CleanSample, PATCH, Sample};

use super::Peer;
use super::ed_tcn::EdTcnConfig;
use super::front_end::FrontEnd;
use super::lda::Lda;
use super::lstm::LstmPeerConfig;
use super::mlp::MlpConfig;
use super::network::Network;
use super::stream::PeerStream;
use super::trahgr::TraHgrConfig;
use shared::model::LookBackLogits;
use myointent::training::tensor::read_back;
use myointent::evaluation::judge::Candidate;
use myointent::run::trial::Trial;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::parallel;
use myointent::execution::run_folder::{RunError, RunFolder};
use myointent::training::dropout::Dropout;

/// What answers.
trait Voice: Send + Sync {
    /// Logits `[windows][answers][classes]` of inputs one after another.
    fn answer(&self, inputs: Vec<Vec<f32>>) -> Vec<f32>;
}

impl Voice for Lda {
    fn answer(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        inputs.iter().flat_map(|input| self.scores(input)).collect()
    }
}

struct Trained<N> {
    network: N,
    device: Device,
}

impl<N: Network + Send> Voice for Trained<N> {
    fn answer(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        let shape = [inputs.len(), inputs[0].len()];
        let input = Tensor::from_data(TensorData::new(inputs.concat(), shape), &self.device);
        read_back(self.network.forward(input, &mut Dropout::off()).remove(0))
    }
}

/// A trained peer.
pub struct TrainedPeer {
    front: FrontEnd,
    classes: usize,
    voice: Box<dyn Voice>,
}

impl TrainedPeer {
    /// Reads a peer from a run's folder; none if it has not been trained there.
    ///
    /// The device is one without gradients.
    ///
    /// # Errors
    /// When its files are damaged or of another shape.
    pub fn load(
        peer: Peer,
        run: &RunFolder,
        classes: usize,
        device: &Device,
    ) -> Result<Option<Self>, RunError> {
        if !run.file(&peer.model_file()).exists() {
            return Ok(None);
        }
        let place = (peer, run, device);
        let voice: Box<dyn Voice> = match peer {
            Peer::Lda => Box::new(run.load_json::<Lda>(&peer.model_file())?),
            Peer::Mlp => network(MlpConfig::default().init(classes, device), place)?,
            Peer::Lstm => network(LstmPeerConfig::default().init(classes, device), place)?,
            Peer::EdTcn => network(EdTcnConfig::default().init(classes, device), place)?,
            Peer::TraHgr => network(TraHgrConfig::default().init(classes, device), place)?,
        };
        Ok(Some(Self {
            front: run.load_json(&peer.front_end_file())?,
            classes,
            voice,
        }))
    }

    /// LookBackLogits at every whole patch of a stream: the window that ends with the patch is heard on its own.
    #[must_use]
    pub fn rows(&self, raw: &[Sample], emg: &[CleanSample]) -> Vec<LookBackLogits> {
        const BATCH: usize = 64;
        let answers = self.front.answers();
        let stream = PeerStream::new(raw, emg, &[]);
        let ends: Vec<usize> = (1..=emg.len() / PATCH).map(|patch| patch * PATCH).collect();
        ends.chunks(BATCH)
            .flat_map(|ends| {
                let inputs = ends
                    .iter()
                    .map(|&end| self.front.hear(stream.heard(end, answers.window)))
                    .collect();
                self.voice
                    .answer(inputs)
                    .chunks_exact(answers.count * self.classes)
                    .map(|logits| answers.rows(logits, self.classes))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// A network's weights, read into a fresh one.
fn network<N: Network + Send + 'static>(
    fresh: N,
    (peer, run, device): (Peer, &RunFolder, &Device),
) -> Result<Box<dyn Voice>, RunError> {
    Ok(Box::new(Trained {
        network: run.load_model(peer.file(), fresh)?.valid(),
        device: device.clone(),
    }))
}

/// Every peer of a run's folder on every trial, in the order of the tables.
///
/// # Errors
/// When a peer's files are damaged or the user interrupts.
pub fn candidates(
    run: &RunFolder,
    trials: &[Trial],
    classes: usize,
    device: &Device,
    interrupt: &Interrupt,
) -> Result<Vec<Candidate>, RunError> {
    let mut candidates = Vec::new();
    for peer in Peer::ALL {
        let Some(trained) = TrainedPeer::load(peer, run, classes, device)? else {
            continue;
        };
        let rows = parallel::map(peer.name(), trials, run, interrupt, |trial| {
            trained.rows(&trial.raw, &trial.emg)
        })?;
        candidates.push(Candidate {
            name: peer.name().to_owned(),
            looks_back: peer.looks_back(),
            rows,
        });
    }
    Ok(candidates)
}
