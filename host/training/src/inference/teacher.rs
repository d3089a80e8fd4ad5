//! Inference of the teacher: one window per patch.

use burn::tensor::Device;
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW};

use crate::optimization::read_back;
use crate::teacher::model::{Teacher, TeacherInput};
use crate::teacher::window::WindowShape;
use presets::augmentation::Variation;
use recordings::corpus::padded;

/// Logits of a teacher at every whole patch of a stream.
///
/// As in the paper, the window that ends at a patch is processed by itself. The logits of a patch are the mean
/// over its samples, without the MASK class. `shape` is that of the model; its window has 60 to 600 samples.
pub fn teacher_logits(
    model: &Teacher,
    shape: WindowShape,
    emg: &[CleanSample],
    device: &Device,
) -> Vec<LookBackLogits> {
    const BATCH: usize = 64;
    let classes = model.classes();
    let stream = padded(emg);
    let ends: Vec<usize> = (0..emg.len() / PATCH)
        .map(|p| WINDOW + (p + 1) * PATCH)
        .collect();
    let mut all = Vec::with_capacity(ends.len());
    for ends in ends.chunks(BATCH) {
        let mut input = Vec::with_capacity(ends.len() * shape.window * CHANNELS);
        for &end in ends {
            Variation::NONE.write(&stream[end - shape.window..end], &mut input);
        }
        let tail = shape.window - LOOK_BACK * PATCH;
        let input = TeacherInput::for_inference(input, shape, classes - 1, device);
        let logits = model
            .forward(input)
            .intent
            .slice([0..ends.len(), tail..shape.window]);
        for window in read_back(logits).chunks_exact(LOOK_BACK * PATCH * classes) {
            let mut newest_first = LookBackLogits::default();
            for (patch, samples) in newest_first
                .iter_mut()
                .rev()
                .zip(window.chunks_exact(PATCH * classes))
            {
                for sample in samples.chunks_exact(classes) {
                    for (mean, logit) in patch.iter_mut().zip(&sample[..classes - 1]) {
                        *mean += logit / PATCH as f32;
                    }
                }
            }
            all.push(newest_first);
        }
    }
    all
}
