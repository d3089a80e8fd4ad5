//! Batch of windows as tensors.

use burn::tensor::{Device, Int, Tensor, TensorData};
use rayon::prelude::*;

use crate::baselines::features::FeatureExtraction;
use crate::baselines::windows::{Window, WindowedCorpus};
use training::optimization::loss::cross_entropy;
use training::optimization::read_back;

/// Inputs and targets of some windows.
pub(super) struct Batch {
    /// Inputs, `[windows, numbers]`.
    pub(super) input: Tensor<2>,
    /// Class of each frame, `[windows, frames, 1]`; 0 where there is no target.
    target: Tensor<3, Int>,
    /// Mask with 1 for each frame with a target, else 0, `[windows, frames]`.
    mask: Tensor<2>,
    /// Number of frames with a target in the mean of the loss: those of this batch, or of the whole optimizer step of which
    /// it is a shard.
    pub(super) targets: f64,
}

impl Batch {
    pub(super) fn new(
        features: &FeatureExtraction,
        corpus: &WindowedCorpus,
        windows: &[Window],
        device: &Device,
    ) -> Self {
        let inputs = extract(features, corpus, windows);
        let (rows, numbers) = (windows.len(), inputs[0].len());
        let targets: Vec<_> = windows
            .iter()
            .flat_map(|&window| corpus.targets(window))
            .collect();
        let classes: Vec<i32> = targets
            .iter()
            .map(|target| target.map_or(0, |intent| intent.class() as i32))
            .collect();
        let mask: Vec<f32> = targets
            .iter()
            .map(|target| f32::from(u8::from(target.is_some())))
            .collect();
        let frames = features.frame_layout().count;
        Self {
            input: Tensor::from_data(TensorData::new(inputs.concat(), [rows, numbers]), device),
            target: Tensor::from_data(TensorData::new(classes, [rows, frames, 1]), device),
            targets: mask.iter().map(|&one| f64::from(one)).sum(),
            mask: Tensor::from_data(TensorData::new(mask, [rows, frames]), device),
        }
    }

    /// Cross entropy: the sum over frames with a target, divided by [`Self::targets`].
    pub(super) fn loss(&self, logits: Tensor<3>) -> Tensor<1> {
        let weight = self.mask.clone().unsqueeze_dim(2);
        cross_entropy(logits, self.target.clone(), weight, self.targets)
    }

    /// Share of the frames with a target whose target has the largest logit.
    pub(super) fn accuracy(&self, logits: Tensor<3>) -> f32 {
        let hits = logits
            .argmax(2)
            .equal(self.target.clone())
            .float()
            .squeeze_dim::<2>(2)
            * self.mask.clone();
        read_back(hits.sum() / self.targets.max(1.0))[0]
    }
}

pub(super) fn extract(
    features: &FeatureExtraction,
    corpus: &WindowedCorpus,
    windows: &[Window],
) -> Vec<Vec<f32>> {
    windows
        .par_iter()
        .map(|&window| features.extract(corpus.samples(window)))
        .collect()
}
