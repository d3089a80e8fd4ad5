//! What a model says at every patch of a stream, whichever model it is.
//!
//! Teacher, float student and integer student are asked the same: after each patch, logits for
//! that patch and the five before it. Everything after this point is the same code for all.

use burn::tensor::{Device, Tensor};
use shared::intent::MAX_CLASSES;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW, WINDOW_PATCHES};

use crate::corpus::Variation;
use crate::student::model::Student;
use crate::teacher::model::Teacher;
use crate::teacher::window::{Grid, inference_input};

/// Logits of the newest six patches, newest first; unused classes are 0.
pub type Rows = [[f32; MAX_CLASSES]; LOOK_BACK];

/// Samples repeated in front of a stream (the reference does the same for its baselines).
const LEAD: usize = 100;

/// The stream with a full window in front: its first 100 samples, six times over.
///
/// So every model judges every sample of a short recording, and none has seen its future.
#[must_use]
pub fn padded(emg: &[CleanSample]) -> Vec<CleanSample> {
    lead_in(emg, WINDOW)
}

/// A stream of any kind with `length` samples in front: its first 100, over and over.
#[must_use]
pub fn lead_in<T: Copy>(samples: &[T], length: usize) -> Vec<T> {
    let lead = &samples[..samples.len().min(LEAD)];
    lead.iter()
        .cycle()
        .take(if lead.is_empty() { 0 } else { length })
        .chain(samples)
        .copied()
        .collect()
}

/// Numbers of a tensor, row by row.
#[must_use]
pub fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor
        .try_into_vec_as::<f32>()
        .expect("a tensor of this device can be read back as f32")
}

/// The class of the largest logit, the lowest one on ties.
#[must_use]
pub fn best_class(logits: &[f32]) -> usize {
    (1..logits.len()).fold(0, |best, class| {
        if logits[class] > logits[best] {
            class
        } else {
            best
        }
    })
}

/// A teacher's rows at every whole patch of a stream.
///
/// `grid` is that of the model; its window is at least the six patches long and at most 600 samples. The window that ends at a patch is run on its own, as the paper does; a patch's row is the mean
/// over its samples, and the MASK class is left out.
#[must_use]
pub fn teacher_rows(
    model: &Teacher,
    grid: Grid,
    emg: &[CleanSample],
    device: &Device,
) -> Vec<Rows> {
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
        for window in numbers(logits).chunks_exact(LOOK_BACK * PATCH * classes) {
            let mut newest_first = Rows::default();
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

/// A float student's rows at every whole patch of a stream.
///
/// Runs pieces with a whole window in front of each, which gives what one long run would: the
/// receptive field is shorter than a window.
#[must_use]
pub fn student_rows(model: &Student, emg: &[CleanSample], device: &Device) -> Vec<Rows> {
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
            numbers(logits)
                .chunks_exact(LOOK_BACK * classes)
                .map(|flat| rows_of(flat, classes)),
        );
    }
    rows
}

/// Rows from `6 * classes` logits, newest patch first.
#[must_use]
pub fn rows_of(flat: &[f32], classes: usize) -> Rows {
    let mut rows = Rows::default();
    for (row, logits) in rows.iter_mut().zip(flat.chunks_exact(classes)) {
        row[..classes].copy_from_slice(logits);
    }
    rows
}
