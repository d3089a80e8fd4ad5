//! The logits of trained baselines at every patch of a recording.

use burn::tensor::{Device, Tensor, TensorData};
use shared::units::{CleanSample, PATCH, Sample};

use super::Baseline;
use super::ed_tcn::EdTcnConfig;
use super::feature_extraction::FeatureExtraction;
use super::lda::Lda;
use super::lstm::LstmBaselineConfig;
use super::mlp::MlpConfig;
use super::network::Network;
use super::stream::PaddedStream;
use super::trahgr::TraHgrConfig;
use myointent::evaluation::Candidate;
use myointent::evaluation::Trial;
use myointent::execution::parallel;
use myointent::execution::run_folder::{RunError, RunFolder};
use myointent::run::context::RunContext;
use myointent::training::dropout::Dropout;
use myointent::training::tensor::read_back;
use shared::pipeline::LookBackLogits;

/// What steps.
trait Predict: Send + Sync {
    /// Logits `[windows][steps][classes]`, input after input.
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32>;
}

impl Predict for Lda {
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        inputs.iter().flat_map(|input| self.scores(input)).collect()
    }
}

struct Trained<N> {
    network: N,
    device: Device,
}

impl<N: Network + Send> Predict for Trained<N> {
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        let shape = [inputs.len(), inputs[0].len()];
        let input = Tensor::from_data(TensorData::new(inputs.concat(), shape), &self.device);
        read_back(self.network.forward(input, &mut Dropout::off()).remove(0))
    }
}

/// A trained baseline.
pub struct TrainedBaseline {
    front: FeatureExtraction,
    classes: usize,
    model: Box<dyn Predict>,
}

impl TrainedBaseline {
    /// Reads a baseline from a run's folder; none if it has not been trained there.
    ///
    /// The device is one without gradients.
    ///
    /// # Errors
    /// When its files are damaged or of another shape.
    pub fn load(
        baseline: Baseline,
        run: &RunFolder,
        classes: usize,
        device: &Device,
    ) -> Result<Option<Self>, RunError> {
        if !run.file(&baseline.model_file()).exists() {
            return Ok(None);
        }
        let place = (baseline, run, device);
        let model: Box<dyn Predict> = match baseline {
            Baseline::Lda => Box::new(run.load_json::<Lda>(&baseline.model_file())?),
            Baseline::Mlp => network(MlpConfig::default().init(classes, device), place)?,
            Baseline::Lstm => network(LstmBaselineConfig::default().init(classes, device), place)?,
            Baseline::EdTcn => network(EdTcnConfig::default().init(classes, device), place)?,
            Baseline::TraHgr => network(TraHgrConfig::default().init(classes, device), place)?,
        };
        Ok(Some(Self {
            front: run.load_json(&baseline.features_file())?,
            classes,
            model,
        }))
    }

    /// Logits at every whole patch of a stream, each from the window that ends with the patch.
    #[must_use]
    pub fn logits(&self, raw: &[Sample], emg: &[CleanSample]) -> Vec<LookBackLogits> {
        const BATCH: usize = 64;
        let steps = self.front.output_steps();
        let stream = PaddedStream::new(raw, emg, &[]);
        let ends: Vec<usize> = (1..=emg.len() / PATCH).map(|patch| patch * PATCH).collect();
        ends.chunks(BATCH)
            .flat_map(|ends| {
                let inputs = ends
                    .iter()
                    .map(|&end| self.front.extract(stream.window(end, steps.window)))
                    .collect();
                self.model
                    .predict(inputs)
                    .chunks_exact(steps.count * self.classes)
                    .map(|logits| steps.to_look_back(logits, self.classes))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// A network's weights, read into a fresh one.
fn network<N: Network + Send + 'static>(
    fresh: N,
    (baseline, run, device): (Baseline, &RunFolder, &Device),
) -> Result<Box<dyn Predict>, RunError> {
    Ok(Box::new(Trained {
        network: run.load_model(baseline.file(), fresh)?.valid(),
        device: device.clone(),
    }))
}

/// Every trained baseline of a run over every trial, in the order of the tables.
///
/// # Errors
/// When a baseline's files are damaged or the user interrupts.
pub fn candidates(context: &RunContext, trials: &[Trial]) -> Result<Vec<Candidate>, RunError> {
    let (folder, classes) = (&context.folder, context.config.preset.classes);
    let device = context.inference_device();
    let mut candidates = Vec::new();
    for baseline in Baseline::ALL {
        let Some(trained) = TrainedBaseline::load(baseline, folder, classes, &device)? else {
            continue;
        };
        let logits = parallel::map(
            baseline.name(),
            trials,
            folder,
            &context.interrupt,
            |trial| trained.logits(&trial.raw, &trial.emg),
        )?;
        candidates.push(Candidate {
            name: baseline.name().to_owned(),
            looks_back: baseline.looks_back(),
            logits,
        });
    }
    Ok(candidates)
}
