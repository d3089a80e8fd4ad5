//! Exponential moving average (EMA) of a model's weights.
//!
//! The average varies less from step to step than the weights themselves: it is what is validated and
//! saved, while training continues on the weights. Source: Polyak and Juditsky (1992), here with
//! exponentially decaying weights.

use burn::module::{Module, ModuleMapper, Param};
use burn::tensor::{Tensor, TensorData};

use crate::weights::values;

/// Average of all weights, in the order in which the module visits them.
#[derive(Clone, Debug)]
pub(super) struct Ema {
    decay: f32,
    steps: usize,
    weights: Vec<f32>,
}

impl Ema {
    /// Starts the average from a model's weights after `steps` steps. Each later step has a weight of `1 - decay`, the first
    /// ones a larger one.
    pub(super) fn new(model: &impl Module, decay: f64, steps: usize) -> Self {
        Self {
            decay: decay as f32,
            steps,
            weights: values(model),
        }
    }

    /// Adds the weights after another step.
    pub(super) fn add(&mut self, model: &impl Module) {
        self.steps += 1;
        // The decay is lower at first, so that the initial weights soon count for little.
        let decay = self
            .decay
            .min(self.steps as f32 / (self.steps as f32 + 10.0));
        for (average, weight) in self.weights.iter_mut().zip(values(model)) {
            *average += (weight - *average) * (1.0 - decay);
        }
    }

    /// The model with the average as its weights.
    pub(super) fn apply<M: Module>(&self, model: M) -> M {
        model.map(&mut Replace(&self.weights))
    }
}

struct Replace<'a>(&'a [f32]);

impl ModuleMapper for Replace<'_> {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let shape = param.dims();
        let (own, rest) = self.0.split_at(shape.iter().product());
        self.0 = rest;
        param
            .map(|tensor| Tensor::from_data(TensorData::new(own.to_vec(), shape), &tensor.device()))
    }
}

#[cfg(test)]
mod tests {
    use burn::nn::{Initializer, Linear, LinearConfig};
    use burn::tensor::Device;

    use super::*;

    fn model(value: f32) -> Linear {
        let zeros = LinearConfig::new(2, 3).with_initializer(Initializer::Zeros);
        let fresh = zeros.init(&Device::default());
        let constant = Ema {
            decay: 0.0,
            steps: 0,
            weights: vec![value; 9],
        };
        constant.apply(fresh)
    }

    #[test]
    fn recent_steps_weigh_more() {
        let mut ema = Ema::new(&model(0.0), 0.5, 100);
        ema.add(&model(1.0));
        ema.add(&model(3.0));
        // 0, then (0 + 1) / 2, then (1/2 + 3) / 2.
        assert_eq!(values(&ema.apply(model(9.0))), [1.75; 9]);
    }

    #[test]
    fn the_initial_weights_soon_count_for_little() {
        let mut ema = Ema::new(&model(100.0), 0.999, 0);
        for _ in 0..50 {
            ema.add(&model(1.0));
        }
        let mean = values(&ema.apply(model(0.0)))[0];
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}
