//! Inference of the float student.

use burn::tensor::{Device, Tensor};
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW_PATCHES};

use crate::optimization::read_back;
use crate::student::model::Student;
use presets::augmentation::Variation;
use recordings::corpus::padded;

/// Logits of a float student at every whole patch of a stream.
///
/// The stream is processed in pieces, each preceded by a window of context. The receptive field is shorter
/// than a window, so the logits are those of one pass over the whole stream.
pub fn student_logits(
    model: &Student,
    emg: &[CleanSample],
    device: &Device,
) -> Vec<LookBackLogits> {
    const PIECE: usize = 120;
    let stream = padded(emg);
    let patches = emg.len() / PATCH;
    let mut all = Vec::with_capacity(patches);
    for first in (0..patches).step_by(PIECE) {
        let count = PIECE.min(patches - first);
        let range = first * PATCH..(first + WINDOW_PATCHES + count) * PATCH;
        let mut input = Vec::with_capacity(range.len() * CHANNELS);
        Variation::NONE.write(&stream[range], &mut input);
        let length = WINDOW_PATCHES + count;
        let input = Tensor::<1>::from_floats(input.as_slice(), device).reshape([
            1,
            length,
            PATCH * CHANNELS,
        ]);
        let logits = model.forward(input).slice([0..1, WINDOW_PATCHES..length]);
        let [_, _, _, outputs] = logits.dims();
        all.extend(
            read_back(logits)
                .chunks_exact(LOOK_BACK * outputs)
                .map(|flat| from_flat(flat, outputs)),
        );
    }
    all
}

/// Logits of one patch from six rows of outputs, newest patch first.
fn from_flat(flat: &[f32], outputs: usize) -> LookBackLogits {
    let mut rows = LookBackLogits::default();
    for (row, logits) in rows.iter_mut().zip(flat.chunks_exact(outputs)) {
        row[..outputs].copy_from_slice(logits);
    }
    rows
}
