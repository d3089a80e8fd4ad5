//! Estimate of the memory that a preset's trainings need.
//!
//! The estimate is in floating-point numbers, whose products do not overflow: a preset may hold any integers. It is for
//! one optimizer step: the weights with their gradients, two moments and average, and the tensors that the backward
//! pass needs of a batch. It is within a factor of three of what was measured, and decides about orders of magnitude
//! only.

use shared::units::{CHANNELS, LOOK_BACK, PATCH};

use crate::Preset;

/// Maximum memory of a step in bytes: 64 GiB. The preset `paper` needs a third of it, on the memory of a large GPU.
pub(super) const LIMIT: f64 = 64.0 * (1_u64 << 30) as f64;

/// Bytes of a number.
const F32: f64 = 4.0;
/// Copies of the weights: weights, gradients, two moments of the optimizer, average.
const COPIES: f64 = 5.0;

impl Preset {
    /// Bytes of a step of the teacher's training.
    pub(crate) fn teacher_bytes(&self) -> f64 {
        let teacher = &self.teacher;
        let [d, hidden, layers] =
            [teacher.d_model, teacher.feed_forward, teacher.layers].map(|size| size as f64);
        let patch = teacher.patch as f64;
        // A token of EMG and one of intent for each patch.
        let tokens = 2.0 * (teacher.window as f64 / patch);
        let weights = layers * (4.0 * d * d + 2.0 * d * hidden)
            + d * (2.0 * CHANNELS as f64 * patch + (self.classes as f64 + 1.0) * patch + tokens);
        let activations = layers
            * (tokens * (12.0 * d + 2.0 * hidden) + 3.0 * teacher.heads as f64 * tokens * tokens);
        F32 * (COPIES * weights + self.teacher_training.batch as f64 * activations)
    }

    /// Bytes of a step of the student's training, and of the list of an epoch's steps.
    pub(crate) fn student_bytes(&self) -> f64 {
        let (student, training) = (&self.student, &self.distillation);
        let [d, layers, patches] =
            [student.d_model, student.layers, training.patches].map(|size| size as f64);
        let weights = layers * (4.0 * d * d + 4.0 * d * d)
            + d * (CHANNELS * PATCH + LOOK_BACK * self.classes) as f64;
        let activations =
            layers * (patches * 16.0 * d + 3.0 * student.heads as f64 * patches * patches);
        let excerpt = size_of::<[usize; 6]>() as f64;
        let batch = training.batch as f64;
        F32 * (COPIES * weights + batch * activations) + excerpt * batch * training.steps as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_preset_fits_and_the_papers_is_the_largest() {
        let paper = Preset::find("paper").unwrap();
        for (name, _) in crate::BUILT_IN {
            let preset = Preset::find(name).unwrap();
            assert!(preset.teacher_bytes() <= paper.teacher_bytes(), "{name}");
            assert!(preset.student_bytes() < LIMIT, "{name}");
        }
        let share = paper.teacher_bytes() / LIMIT;
        assert!((0.2..0.5).contains(&share), "{share}");
    }
}
