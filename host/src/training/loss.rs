//! The loss that everything that names a class is trained with.

use burn::tensor::activation::log_softmax;
use burn::tensor::{Int, Tensor};

/// Cross entropy of logits, classes along the last axis: the weighted sum over all cells, over `cells`.
///
/// `label` and `weight` have 1 along that axis. A mean over the labelled cells takes weights of 1 and 0 and as
/// `cells` their sum, over the whole batch where a batch is computed in parts; below 1 it counts as 1.
#[must_use]
pub fn cross_entropy<const D: usize>(
    logits: Tensor<D>,
    label: Tensor<D, Int>,
    weight: Tensor<D>,
    cells: f64,
) -> Tensor<1> {
    let log_probability = log_softmax(logits, D - 1).gather(D - 1, label);
    (log_probability * weight).sum() * (-1.0 / cells.max(1.0))
}

#[cfg(test)]
mod tests {
    use burn::tensor::{Device, TensorData};

    use super::*;
    use crate::training::tensor::read_back;

    #[test]
    fn it_is_the_mean_over_the_labelled_cells() {
        let device = Device::default();
        let logits = [[0.0_f32, 2.0_f32.ln()], [5.0, -5.0], [0.0, 0.0]].concat();
        let of = |cells| {
            let loss = cross_entropy(
                Tensor::<2>::from_data(TensorData::new(logits.clone(), [3, 2]), &device),
                Tensor::from_data(TensorData::new(vec![1_i32, 0, 0], [3, 1]), &device),
                Tensor::from_data(TensorData::new(vec![1.0_f32, 0.0, 1.0], [3, 1]), &device),
                cells,
            );
            read_back(loss)[0]
        };
        let sum = 1.5_f32.ln() + 2.0_f32.ln();
        assert!((of(2.0) - sum / 2.0).abs() < 1e-6);
        assert!((of(0.0) - sum).abs() < 1e-6);
    }
}
