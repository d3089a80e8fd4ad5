//! Logits of trained baselines at every patch of a recording.

use burn::tensor::{Device, Tensor, TensorData};
use shared::model::LookBackLogits;
use shared::units::{PATCH, Sample};

use super::Baseline;
use super::features::FeatureExtraction;
use super::networks::{EdTcnConfig, LstmBaselineConfig, Network};
use super::windows::PaddedStream;
use evaluation::Candidate;
use evaluation::EvaluatedRecording;
use execution::fingerprint::Fingerprint;
use execution::progress;
use execution::run_folder::{RunError, RunFolder};
use training::optimization::read_back;
use training::run::context::RunContext;
use training::weights::Weights as _;

/// Number of windows that are predicted at once.
const BATCH: usize = 256;

/// Model that predicts from features.
trait Predict: Send + Sync {
    /// Computes logits `[windows][frames][classes]`, from one input per window.
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32>;
}

/// Network and the device that holds its weights.
struct NetworkOnDevice<N> {
    network: N,
    device: Device,
}

impl<N: Network + Send> Predict for NetworkOnDevice<N> {
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        let shape = [inputs.len(), inputs[0].len()];
        let input = Tensor::from_data(TensorData::new(inputs.concat(), shape), &self.device);
        read_back(self.network.forward(input))
    }
}

pub(crate) struct TrainedBaseline {
    features: FeatureExtraction,
    classes: usize,
    model: Box<dyn Predict>,
}

impl TrainedBaseline {
    /// Loads a baseline that was trained on these streams from a run folder.
    ///
    /// `device` must be without gradients.
    pub(crate) fn load(
        baseline: Baseline,
        run: &RunFolder,
        streams: Fingerprint,
        classes: usize,
        device: &Device,
    ) -> Result<Self, RunError> {
        let features: FeatureExtraction = run
            .load_stamped(&baseline.features_file(), streams)?
            .content;
        let made_from = features.lineage(streams);
        let from = (baseline, run, made_from, device);
        let model: Box<dyn Predict> = match baseline {
            Baseline::Lstm => load(LstmBaselineConfig::default().init(classes, device), from)?,
            Baseline::EdTcn => load(EdTcnConfig::default().init(classes, device), from)?,
        };
        Ok(Self {
            features,
            classes,
            model,
        })
    }

    /// Computes the logits at every whole patch of a stream, each from the window that ends with the patch.
    pub(crate) fn logits(&self, raw: &[Sample]) -> Vec<LookBackLogits> {
        let layout = self.features.frame_layout();
        let stream = PaddedStream::new(raw, &[]);
        let ends: Vec<usize> = (1..=raw.len() / PATCH).map(|patch| patch * PATCH).collect();
        ends.chunks(BATCH)
            .flat_map(|ends| {
                let inputs = ends
                    .iter()
                    .map(|&end| self.features.extract(stream.window(end, layout.window)))
                    .collect();
                self.model
                    .predict(inputs)
                    .chunks_exact(layout.count * self.classes)
                    .map(|logits| layout.look_back_logits(logits, self.classes))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// Loads trained weights into a network with random ones.
fn load<N: Network + Send + 'static>(
    network: N,
    (baseline, run, made_from, device): (Baseline, &RunFolder, Fingerprint, &Device),
) -> Result<Box<dyn Predict>, RunError> {
    Ok(Box::new(NetworkOnDevice {
        network: run
            .load_model(baseline.file_stem(), made_from, network)?
            .valid(),
        device: device.clone(),
    }))
}

/// Loads a trained baseline of a run, with its logits over the recordings.
pub(crate) fn candidate(
    context: &RunContext,
    baseline: Baseline,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, RunError> {
    let (folder, classes) = (&context.folder, context.config.preset.classes);
    let (device, streams) = (context.inference_device(), context.config.streams_lineage());
    let trained = TrainedBaseline::load(baseline, folder, streams, classes, &device)?;
    let logits = progress::map(
        baseline.name(),
        recordings,
        folder,
        &context.interrupt,
        |recording| trained.logits(&recording.raw),
    )?;
    Ok(Candidate::without_margins(baseline.name(), true, logits))
}
