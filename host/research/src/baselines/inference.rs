//! Logits of trained baselines at every patch of a recording.

use burn::tensor::{Device, Tensor, TensorData};
use shared::model::LookBackLogits;
use shared::units::{CleanSample, PATCH, Sample};

use super::Baseline;
use super::features::FeatureExtraction;
use super::lda::Lda;
use super::networks::{EdTcnConfig, LstmBaselineConfig, MlpConfig, Network, TraHgrConfig};
use super::windows::PaddedStream;
use evaluation::Candidate;
use evaluation::EvaluatedRecording;
use execution::fingerprint::Fingerprint;
use execution::progress;
use execution::run_folder::{RunError, RunFolder};
use training::optimization::dropout::Dropout;
use training::optimization::read_back;
use training::run::context::RunContext;
use training::run::evaluate::if_own;
use training::weights::Weights as _;

/// Number of windows that are predicted at once.
const BATCH: usize = 256;

/// Model that predicts from features.
trait Predict: Send + Sync {
    /// Computes logits `[windows][frames][classes]`, from one input per window.
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32>;
}

impl Predict for Lda {
    fn predict(&self, inputs: Vec<Vec<f32>>) -> Vec<f32> {
        inputs.iter().flat_map(|input| self.scores(input)).collect()
    }
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
        read_back(self.network.forward(input, &mut Dropout::off()).remove(0))
    }
}

/// Trained baseline.
pub(crate) struct TrainedBaseline {
    features: FeatureExtraction,
    classes: usize,
    model: Box<dyn Predict>,
}

impl TrainedBaseline {
    /// Loads a baseline that was trained on these streams from a run folder.
    ///
    /// `device` must be without gradients.
    ///
    /// # Errors
    /// When the baseline's files are missing, damaged, of other streams or of another shape.
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
            Baseline::Lda => {
                let file = run.load_stamped::<Lda>(&baseline.model_file(), made_from)?;
                Box::new(file.content)
            }
            Baseline::Mlp => load(MlpConfig::default().init(classes, device), from)?,
            Baseline::Lstm => load(LstmBaselineConfig::default().init(classes, device), from)?,
            Baseline::EdTcn => load(EdTcnConfig::default().init(classes, device), from)?,
            Baseline::TraHgr => load(TraHgrConfig::default().init(classes, device), from)?,
        };
        Ok(Self {
            features,
            classes,
            model,
        })
    }

    /// Computes the logits at every whole patch of a stream, each from the window that ends with the patch.
    pub(crate) fn logits(&self, raw: &[Sample], emg: &[CleanSample]) -> Vec<LookBackLogits> {
        let layout = self.features.frame_layout();
        let stream = PaddedStream::new(raw, emg, &[]);
        let ends: Vec<usize> = (1..=emg.len() / PATCH).map(|patch| patch * PATCH).collect();
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

/// Loads every trained baseline of a run, with its logits over the recordings, in the order of the tables.
///
/// # Errors
/// When a baseline's files are damaged or the user interrupts.
pub(crate) fn candidates(
    context: &RunContext,
    recordings: &[EvaluatedRecording],
) -> Result<Vec<Candidate>, RunError> {
    let mut candidates = Vec::new();
    for baseline in Baseline::ALL {
        let is_trained = context.folder.file(&baseline.model_file()).exists();
        if is_trained {
            candidates.extend(if_own(candidate(context, baseline, recordings))?);
        }
    }
    Ok(candidates)
}

/// Loads a trained baseline of a run, with its logits over the recordings.
///
/// # Errors
/// When the baseline is missing, its files are damaged or another run's, or the user interrupts.
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
        |recording| trained.logits(&recording.raw, &recording.emg),
    )?;
    let looks_back = baseline.looks_back();
    Ok(Candidate::without_margins(
        baseline.name(),
        looks_back,
        logits,
    ))
}
