//! Training of teacher, student and baselines: the loop, the learning-rate schedule, weight averaging, the loss, dropout,
//! augmentation.

mod checkpoint;
pub mod dropout;
mod ema;
mod epoch;
pub mod fit;
#[cfg(feature = "flex")]
pub(crate) mod kernels;
pub mod learner;
pub mod loss;
pub(crate) mod metrics;
pub mod optimizer;
pub(crate) mod tune;

use std::sync::{Mutex, PoisonError};

use burn::module::Module;
#[cfg(test)]
use burn::nn::Initializer;
use burn::tensor::{Device, Tensor};

use crate::weights::values;

/// Seed of a model of which all weights are replaced.
pub const REPLACED: u64 = 0;

/// Creates a model and draws its initial weights from a seed.
///
/// Burn has one generator for a device, which all threads share, and draws a weight when it is first read. Here all weights are
/// drawn at once and by one thread at a time: trainings in parallel repeat theirs. A call within `create` waits for ever.
pub fn initial<M: Module>(seed: u64, device: &Device, create: impl FnOnce() -> M) -> M {
    static GENERATOR: Mutex<()> = Mutex::new(());
    let _alone = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
    device.seed(seed);
    let model = create();
    values(&model);
    model
}

/// Draws a tensor, normally distributed, for a test.
#[cfg(test)]
pub(crate) fn random<const D: usize>(seed: u64, dims: [usize; D], device: &Device) -> Tensor<D> {
    let (mean, std) = (0.0, 1.0);
    let drawn = || Initializer::Normal { mean, std }.init(dims, device);
    initial(seed, device, drawn).val().detach()
}

/// Reads the values of a tensor in row-major order.
///
/// # Panics
/// When a GPU could not compute the tensor, for instance for lack of memory. Never on CPU backends, whose floats convert to f32.
pub fn read_back<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor
        .try_into_vec_as::<f32>()
        .expect("a tensor of this device can be read back as f32")
}

/// Class of the largest logit, the lowest one on ties.
pub fn best_class(logits: &[f32]) -> usize {
    (1..logits.len()).fold(0, |best, class| {
        if logits[class] > logits[best] {
            class
        } else {
            best
        }
    })
}

#[cfg(test)]
mod tests {
    use burn::nn::LinearConfig;

    use super::*;

    #[test]
    fn models_made_in_parallel_have_the_weights_of_their_seed() {
        let drawn = |seed| {
            let device = Device::default();
            let model = initial(seed, &device, || LinearConfig::new(40, 50).init(&device));
            values(&model)
        };
        let expected = [drawn(0), drawn(1)];
        std::thread::scope(|scope| {
            for seed in [0, 1].repeat(4) {
                let expected = &expected[seed as usize];
                scope.spawn(move || (0..50).for_each(|_| assert!(drawn(seed) == *expected)));
            }
        });
    }
}
