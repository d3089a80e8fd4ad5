//! Logits of trained baselines at every patch of a recording.

use burn::tensor::{Device, Tensor, TensorData};
use shared::model::LookBackLogits;
use shared::units::{PATCH, Sample};

use super::Baseline;
use super::features::FeatureExtraction;
use super::networks::{EdTcn, LstmBaseline, Network};
use super::windows::PaddedStream;
use evaluation::Candidate;
use evaluation::EvaluatedRecording;
use execution::fingerprint::Fingerprint;
use execution::progress;
use execution::run_folder::{RunError, RunFolder};
use training::optimization::{REPLACED, read_back};
use training::run::context::RunContext;
use training::weights::load_model;

/// Number of windows that are predicted at once.
const BATCH: usize = 256;

/// Network with trained weights: logits `[windows][frames][classes]` of one input per window.
type Predict = dyn Fn(Vec<Vec<f32>>) -> Vec<f32> + Send + Sync;

pub(crate) struct TrainedBaseline {
    features: FeatureExtraction,
    classes: usize,
    predict: Box<Predict>,
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
        let features: FeatureExtraction = run.load_stamped(&baseline.features_file(), streams)?;
        let made_from = features.lineage(streams);
        let from = (baseline, run, made_from, device);
        let predict = match baseline {
            Baseline::Lstm => load(LstmBaseline::new(REPLACED, classes, device), from)?,
            Baseline::EdTcn => load(EdTcn::new(REPLACED, classes, device), from)?,
        };
        Ok(Self {
            features,
            classes,
            predict,
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
                (self.predict)(inputs)
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
) -> Result<Box<Predict>, RunError> {
    let model = load_model(run, baseline.file_stem(), made_from, network)?;
    let (network, device) = (model.valid(), device.clone());
    Ok(Box::new(move |inputs| {
        let shape = [inputs.len(), inputs[0].len()];
        let input = Tensor::from_data(TensorData::new(inputs.concat(), shape), &device);
        read_back(network.forward(input))
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
