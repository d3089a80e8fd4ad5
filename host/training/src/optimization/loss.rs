//! The classification loss.

use burn::tensor::activation::log_softmax;
use burn::tensor::{Int, Tensor};

/// Cross entropy of logits with classes along the last axis: the weighted sum over all positions, divided by `count`.
///
/// `label` and `weight` have length 1 along that axis. For the mean over labelled positions, weights are 1 where there
/// is a label and 0 elsewhere, and `count` is the number of labels, of the whole batch where a batch is computed in
/// parts. A `count` below 1 is taken as 1.
pub fn cross_entropy<const D: usize>(
    logits: Tensor<D>,
    label: Tensor<D, Int>,
    weight: Tensor<D>,
    count: f64,
) -> Tensor<1> {
    let log_probability = log_softmax(logits, D - 1).gather(D - 1, label);
    (log_probability * weight).sum() * (-1.0 / count.max(1.0))
}

#[cfg(test)]
mod tests {
    use burn::tensor::{Device, TensorData};

    use super::*;
    use crate::optimization::read_back;

    #[test]
    fn it_is_the_mean_over_the_labelled_positions() {
        let device = Device::default();
        let logits = [[0.0_f32, 2.0_f32.ln()], [5.0, -5.0], [0.0, 0.0]].concat();
        let of = |count| {
            let loss = cross_entropy(
                Tensor::<2>::from_data(TensorData::new(logits.clone(), [3, 2]), &device),
                Tensor::from_data(TensorData::new(vec![1_i32, 0, 0], [3, 1]), &device),
                Tensor::from_data(TensorData::new(vec![1.0_f32, 0.0, 1.0], [3, 1]), &device),
                count,
            );
            read_back(loss)[0]
        };
        let sum = 1.5_f32.ln() + 2.0_f32.ln();
        assert!((of(2.0) - sum / 2.0).abs() < 1e-6);
        assert!((of(0.0) - sum).abs() < 1e-6);
    }
}
