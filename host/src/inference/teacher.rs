//! The teacher over a stream: a window a patch.

use burn::tensor::Device;
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW};

use crate::dataset::lead_in::padded;
use crate::teacher::model::Teacher;
use crate::teacher::window::{Grid, inference_input};
use crate::training::augmentation::Variation;
use crate::training::tensor::read_back;

/// A teacher's rows at every whole patch of a stream.
///
/// `grid` is that of the model; its window is at least the six patches long and at most 600 samples. The window that ends at a patch is run on its own, as the paper does; a patch's row is the mean
/// over its samples, and the MASK class is left out.
#[must_use]
pub fn teacher_logits(
    model: &Teacher,
    grid: Grid,
    emg: &[CleanSample],
    device: &Device,
) -> Vec<LookBackLogits> {
    const BATCH: usize = 64;
    let classes = model.classes();
    let stream = padded(emg);
    let ends: Vec<usize> = (0..emg.len() / PATCH)
        .map(|p| WINDOW + (p + 1) * PATCH)
        .collect();
    let mut rows = Vec::with_capacity(ends.len());
    for ends in ends.chunks(BATCH) {
        let mut input = Vec::with_capacity(ends.len() * grid.window * CHANNELS);
        for &end in ends {
            Variation::NONE.write(&stream[end - grid.window..end], &mut input);
        }
        let tail = grid.window - LOOK_BACK * PATCH;
        let input = inference_input(input, grid, classes - 1, device);
        let logits = model
            .forward(input)
            .intent
            .slice([0..ends.len(), tail..grid.window]);
        for window in read_back(logits).chunks_exact(LOOK_BACK * PATCH * classes) {
            let mut newest_first = LookBackLogits::default();
            for (row, samples) in newest_first
                .iter_mut()
                .rev()
                .zip(window.chunks_exact(PATCH * classes))
            {
                for sample in samples.chunks_exact(classes) {
                    for (sum, logit) in row.iter_mut().zip(&sample[..classes - 1]) {
                        *sum += logit / PATCH as f32;
                    }
                }
            }
            rows.push(newest_first);
        }
    }
    rows
}
