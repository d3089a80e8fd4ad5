//! Ensemble of students that teaches another one.
//!
//! It labels every batch as the student sees it, with gains and rotations drawn anew. Only with such unlimited examples
//! does a student learn what several students know beyond one (docs/decisions.md#why-does-an-ensemble-teach-the-student).

use burn::tensor::Tensor;
use burn::tensor::activation::softmax;

use super::model::Student;

/// Trained students, without gradients.
pub struct Ensemble {
    members: Vec<Student>,
}

impl Ensemble {
    /// Creates an ensemble of at least one student.
    pub const fn new(members: Vec<Student>) -> Self {
        Self { members }
    }

    /// Logarithm of the members' mean probabilities, as logits without gradients: `[b, patches, 6, outputs of a row]`.
    ///
    /// `emg` and the result are on a device with gradients.
    pub(super) fn logits(&self, emg: Tensor<3>) -> Tensor<4> {
        let emg = emg.inner();
        let sum = self
            .members
            .iter()
            .map(|member| softmax(member.forward(emg.clone()), 3))
            .reduce(|sum, one| sum + one)
            .expect("an ensemble has a member");
        // A probability that underflows has no logarithm.
        let mean = (sum / self.members.len() as f64).clamp_min(1e-20);
        Tensor::from_inner(mean.log())
    }
}

#[cfg(test)]
mod tests {
    use burn::module::Module as _;
    use burn::tensor::Device;

    use super::*;
    use crate::optimization::{random, read_back};
    use presets::Preset;

    #[test]
    fn the_ensemble_is_the_mean_of_its_members_probabilities() {
        let device = Device::default().autodiff();
        let config = Preset::find("cpu").unwrap().student;
        let members: Vec<Student> = (0..3)
            .map(|seed| Student::new(seed, &config, 3, true, &device).valid())
            .collect();
        let emg = random(7, [2, 40, 80], &device).abs();
        let each: Vec<Vec<f32>> = members
            .iter()
            .map(|member| read_back(softmax(member.forward(emg.clone().inner()), 3)))
            .collect();
        let logits = Ensemble::new(members).logits(emg);
        assert_eq!(logits.dims(), [2, 40, 6, 4]);
        let found = read_back(softmax(logits, 3));
        for (at, &found) in found.iter().enumerate() {
            let mean = each.iter().map(|own| own[at]).sum::<f32>() / 3.0;
            assert!((found - mean).abs() < 1e-5, "{at}: {found}, {mean}");
        }
    }
}
