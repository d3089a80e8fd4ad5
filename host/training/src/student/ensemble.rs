//! Ensemble of students that teaches another one.
//!
//! It labels every batch as the student sees it, with gains and rotations drawn anew. Only with such unlimited examples
//! does a student learn what several students know beyond one (docs/decisions.md#why-does-an-ensemble-teach-the-student).

use burn::tensor::activation::softmax;
use burn::tensor::{Tensor, TensorData};

use super::model::Student;

/// Trained students, without gradients.
pub struct Ensemble {
    members: Vec<Student>,
    hindsight: bool,
}

impl Ensemble {
    /// Creates an ensemble of at least one student; with `hindsight`, the target of an instant is the same in all windows.
    #[must_use]
    pub fn new(members: Vec<Student>, hindsight: bool) -> Self {
        Self { members, hindsight }
    }

    /// Logarithm of the members' mean probabilities, as logits without gradients: `[b, patches, 6, outputs of a row]`.
    /// With hindsight its mean over the windows that see an instant, as the smoother sums them.
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
        let logits = mean.log();
        Tensor::from_inner(if self.hindsight {
            in_hindsight(&logits)
        } else {
            logits
        })
    }
}

/// Replaces each row by the mean of its instant's rows in all windows that see it; near the end there are fewer. The first
/// windows, whose older instants are before the first patch, keep the mean of the first one there.
fn in_hindsight(logits: &Tensor<4>) -> Tensor<4> {
    let [b, patches, rows, outputs] = logits.dims();
    let device = logits.device();
    let sum = (0..rows.min(patches)).map(|back| {
        let row = [0..b, back..patches, back..back + 1, 0..outputs];
        let behind_the_end = Tensor::zeros([b, back, 1, outputs], &device);
        Tensor::cat(vec![logits.clone().slice(row), behind_the_end], 1)
    });
    let sum = sum.reduce(|sum, one| sum + one).expect("a row");
    let counts: Vec<f32> = (0..patches)
        .map(|patch| rows.min(patches - patch) as f32)
        .collect();
    let counts = TensorData::new(counts, [1, patches, 1, 1]);
    let mean = sum / Tensor::from_data(counts, &device);
    let shifted = (0..rows).map(|back| {
        let first = mean.clone().slice([0..b, 0..1, 0..1, 0..outputs]);
        let first = first.repeat_dim(1, back.min(patches));
        let kept = mean.clone().slice([0..b, 0..patches.saturating_sub(back)]);
        Tensor::cat(vec![first, kept], 1)
    });
    Tensor::cat(shifted.collect(), 2)
}

#[cfg(test)]
mod tests {
    use burn::module::Module as _;
    use burn::tensor::{Device, Distribution};

    use super::*;
    use crate::optimization::read_back;
    use presets::Preset;
    use shared::units::LOOK_BACK;

    #[test]
    fn the_ensemble_is_the_mean_of_its_members_probabilities() {
        let device = Device::default().autodiff();
        let config = Preset::find("cpu").unwrap().student;
        let members: Vec<Student> = (0..3)
            .map(|seed| {
                device.seed(seed);
                Student::new(&config, 3, true, &device).valid()
            })
            .collect();
        let emg = Tensor::<3>::random([2, 40, 80], Distribution::Uniform(0.0, 1.0), &device);
        let each: Vec<Vec<f32>> = members
            .iter()
            .map(|member| read_back(softmax(member.forward(emg.clone().inner()), 3)))
            .collect();
        let logits = Ensemble::new(members, false).logits(emg);
        assert_eq!(logits.dims(), [2, 40, 6, 4]);
        let found = read_back(softmax(logits, 3));
        for (at, &found) in found.iter().enumerate() {
            let mean = each.iter().map(|own| own[at]).sum::<f32>() / 3.0;
            assert!((found - mean).abs() < 1e-5, "{at}: {found}, {mean}");
        }
    }

    #[test]
    fn in_hindsight_an_instant_has_the_mean_of_all_windows_that_see_it() {
        let device = Device::default();
        let (b, patches, rows, outputs) = (2, 9, LOOK_BACK, 3);
        let logits = Tensor::<4>::random(
            [b, patches, rows, outputs],
            Distribution::Uniform(-4.0, 0.0),
            &device,
        );
        let [before, found] = [logits.clone(), in_hindsight(&logits)].map(read_back);
        let at = |excerpt, patch, back, output| {
            ((excerpt * patches + patch) * rows + back) * outputs + output
        };
        for (excerpt, output) in [(0, 0), (0, 2), (1, 1)] {
            for instant in 0..patches {
                let seen: Vec<usize> = (0..rows).filter(|back| instant + back < patches).collect();
                let own = seen
                    .iter()
                    .map(|&back| before[at(excerpt, instant + back, back, output)]);
                let mean = own.sum::<f32>() / seen.len() as f32;
                for &back in &seen {
                    let found = found[at(excerpt, instant + back, back, output)];
                    assert!((found - mean).abs() < 1e-5, "{instant} {back}");
                }
            }
        }
    }
}
