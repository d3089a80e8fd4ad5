//! All weights of a model as one row of values, in the order in which the module visits them.

use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{Tensor, TensorData};

/// The weights of a model.
pub(crate) fn weights(model: &impl Module) -> Vec<f32> {
    let mut collected = Collect(Vec::new());
    model.visit(&mut collected);
    collected.0
}

/// The model with other weights.
///
/// # Panics
/// If there are fewer than the model has.
pub(crate) fn with_weights<M: Module>(model: M, weights: &[f32]) -> M {
    model.map(&mut Replace(weights))
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
