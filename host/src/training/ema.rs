//! Exponential moving average (EMA) of a model's weights, steadier than the weights of any one step.
//!
//! After Polyak and Juditsky (1992), recent steps weighed more: the average is validated and saved,
//! the model itself goes on training.

use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{Tensor, TensorData};

/// The average of all weights, in the order in which the module shows them.
#[derive(Clone, Debug)]
pub struct Ema {
    decay: f32,
    steps: usize,
    weights: Vec<f32>,
}

impl Ema {
    /// Begins with the model as it is, after so many steps; each later step takes over `1 - decay` of the mean, and
    /// more at first.
    #[must_use]
    pub fn new(model: &impl Module, decay: f64, steps: usize) -> Self {
        Self {
            decay: decay as f32,
            steps,
            weights: weights(model),
        }
    }

    /// Takes in the weights after another step.
    pub fn add(&mut self, model: &impl Module) {
        self.steps += 1;
        // The first steps' weights are soon forgotten.
        let decay = self
            .decay
            .min(self.steps as f32 / (self.steps as f32 + 10.0));
        for (mean, weight) in self.weights.iter_mut().zip(weights(model)) {
            *mean += (weight - *mean) * (1.0 - decay);
        }
    }

    /// The model with the mean for its weights.
    #[must_use]
    pub fn apply<M: Module>(&self, model: M) -> M {
        model.map(&mut Replace(&self.weights))
    }
}

fn weights(model: &impl Module) -> Vec<f32> {
    let mut collected = Collect(Vec::new());
    model.visit(&mut collected);
    collected.0
}

struct Collect(Vec<f32>);

impl ModuleVisitor for Collect {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        self.0.extend(param.val().into_data().iter::<f32>());
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
    use burn::nn::{Linear, LinearConfig};
    use burn::tensor::Device;

    use super::*;

    fn model(value: f32) -> Linear {
        let fresh = LinearConfig::new(2, 3).init(&Device::default());
        let constant = Ema {
            decay: 0.0,
            steps: 0,
            weights: vec![value; 9],
        };
        constant.apply(fresh)
    }

    #[test]
    fn the_mean_lies_between_the_steps_and_leans_on_the_recent_ones() {
        let mut ema = Ema::new(&model(0.0), 0.5, 100);
        ema.add(&model(1.0));
        ema.add(&model(3.0));
        // 0, then (0 + 1) / 2, then (1/2 + 3) / 2.
        assert_eq!(weights(&ema.apply(model(9.0))), [1.75; 9]);
    }

    #[test]
    fn a_young_mean_follows_its_model() {
        let mut ema = Ema::new(&model(100.0), 0.999, 0);
        for _ in 0..50 {
            ema.add(&model(1.0));
        }
        let mean = weights(&ema.apply(model(0.0)))[0];
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}
