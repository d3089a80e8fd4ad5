//! The float student over a stream.

use burn::tensor::{Device, Tensor};
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW_PATCHES};

use crate::dataset::lead_in::padded;
use crate::student::model::Student;
use crate::training::augmentation::Variation;
use crate::training::tensor::read_back;

/// A float student's rows at every whole patch of a stream.
///
/// Runs pieces with a whole window in front of each, which gives what one long run would: the
/// receptive field is shorter than a window.
#[must_use]
pub fn student_logits(
    model: &Student,
    emg: &[CleanSample],
    device: &Device,
) -> Vec<LookBackLogits> {
    const PIECE: usize = 120;
    let stream = padded(emg);
    let patches = emg.len() / PATCH;
    let mut rows = Vec::with_capacity(patches);
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
        let [_, _, _, classes] = logits.dims();
        rows.extend(
            read_back(logits)
                .chunks_exact(LOOK_BACK * classes)
                .map(|flat| from_flat(flat, classes)),
        );
    }
    rows
}

/// LookBackLogits from `6 * classes` logits, newest patch first.
#[must_use]
pub fn from_flat(flat: &[f32], classes: usize) -> LookBackLogits {
    let mut rows = LookBackLogits::default();
    for (row, logits) in rows.iter_mut().zip(flat.chunks_exact(classes)) {
        row[..classes].copy_from_slice(logits);
    }
    rows
}
