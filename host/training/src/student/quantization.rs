//! Quantization of a trained float student to a model file.

use burn::module::Param;
use burn::nn::{LayerNorm, Linear};
use burn::tensor::Tensor;
use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::{
    LayerParts, LinearParts, ModelError, ModelParts, NormParts, ProvenanceParts, SmootherDefaults,
};

use shared::stream::alignment::Template;
use shared::stream::preprocess::Preprocessing;

use super::model::{Student, StudentConfig};
use crate::optimization::read_back;

/// Encodes the model file: weights rounded to i8 with one scale per output row, everything else in f32.
pub(crate) fn quantize(
    student: &Student,
    config: &StudentConfig,
    vocabulary: Vocabulary,
    (smoother, preprocessing): (SmootherDefaults, Preprocessing),
    template: Option<Template>,
    provenance: ProvenanceParts,
) -> Result<Vec<u8>, ModelError> {
    let StudentConfig {
        d_model,
        layers,
        span,
        companding,
        ..
    } = *config;
    ModelParts {
        dimensions: Dimensions {
            width: d_model,
            layers,
            span,
            vocabulary,
            other: student.other,
        },
        companding,
        preprocessing,
        smoother,
        template,
        provenance,
        embed: linear(&student.embed),
        layers: student
            .layers
            .iter()
            .map(|layer| LayerParts {
                norm1: norm(&layer.norm1),
                qkv: linear(&layer.qkv),
                relative_bias: parameter(&layer.relative_bias),
                out: linear(&layer.out),
                norm2: norm(&layer.norm2),
                ff1: linear(&layer.ff1),
                ff2: linear(&layer.ff2),
            })
            .collect(),
        final_norm: norm(&student.final_norm),
        head: linear(&student.head),
    }
    .to_bytes()
}

/// Converts a linear layer. Rows of a model file's matrix are outputs; Burn's matrices are inputs by outputs.
fn linear(linear: &Linear) -> LinearParts {
    let rows = read_back(linear.weight.val().transpose());
    let bias = linear
        .bias
        .as_ref()
        .map_or_else(|| vec![0.0; linear.weight.dims()[1]], parameter);
    LinearParts::quantized(&rows, bias)
}

fn norm(norm: &LayerNorm) -> NormParts {
    let gain = parameter(&norm.gamma);
    let bias = norm
        .beta
        .as_ref()
        .map_or_else(|| vec![0.0; gain.len()], parameter);
    NormParts { gain, bias }
}

fn parameter<const D: usize>(parameter: &Param<Tensor<D>>) -> Vec<f32> {
    read_back(parameter.val())
}
