//! Conversion of a model file to a float student, from which fine-tuning starts.

use burn::module::Param;
use burn::nn::{LayerNorm, Linear};
use burn::tensor::{Device, Tensor, TensorData};
use shared::model::file::{LinearParts, ModelParts, NormParts};

use super::model::{HEADS, Student, StudentConfig};
use crate::optimization::REPLACED;

/// Creates the student with the weights that a model file stores; also returns its dimensions.
pub fn dequantize(parts: &ModelParts, device: &Device) -> (Student, StudentConfig) {
    let dimensions = &parts.dimensions;
    let config = StudentConfig {
        d_model: dimensions.width,
        heads: HEADS,
        layers: dimensions.layers,
        span: dimensions.span,
        companding: parts.companding,
        board: true,
    };
    let mut student = Student::new(
        REPLACED,
        &config,
        dimensions.vocabulary.classes(),
        dimensions.other,
        device,
    );
    set_linear(&mut student.embed, &parts.embed, device);
    for (layer, own) in student.layers.iter_mut().zip(&parts.layers) {
        set_norm(&mut layer.norm1, &own.norm1, device);
        set_linear(&mut layer.qkv, &own.qkv, device);
        let shape = [config.heads, config.span];
        layer.relative_bias = parameter(&own.relative_bias, shape, device);
        set_linear(&mut layer.out, &own.out, device);
        set_norm(&mut layer.norm2, &own.norm2, device);
        set_linear(&mut layer.ff1, &own.ff1, device);
        set_linear(&mut layer.ff2, &own.ff2, device);
    }
    set_norm(&mut student.final_norm, &parts.final_norm, device);
    set_linear(&mut student.head, &parts.head, device);
    (student, config)
}

/// Sets a linear layer. Rows of a model file's matrix are outputs; Burn's matrices are inputs by outputs.
fn set_linear(linear: &mut Linear, parts: &LinearParts, device: &Device) {
    let [inputs, outputs] = linear.weight.dims();
    let rows = parts.dequantized();
    let by_input = (0..inputs)
        .flat_map(|input| rows.iter().skip(input).step_by(inputs))
        .copied()
        .collect::<Vec<f32>>();
    linear.weight = parameter(&by_input, [inputs, outputs], device);
    linear.bias = Some(parameter(&parts.bias, [outputs], device));
}

fn set_norm(norm: &mut LayerNorm, parts: &NormParts, device: &Device) {
    let width = [parts.gain.len()];
    norm.gamma = parameter(&parts.gain, width, device);
    norm.beta = Some(parameter(&parts.bias, width, device));
}

fn parameter<const D: usize>(
    values: &[f32],
    shape: [usize; D],
    device: &Device,
) -> Param<Tensor<D>> {
    Param::from_data(TensorData::new(values.to_vec(), shape), device)
}

#[cfg(test)]
mod tests {
    use shared::intent::Vocabulary;
    use shared::model::dimensions::Dimensions;
    use shared::model::file::Model;
    use shared::model::file::random::random_model;
    use shared::units::CHANNELS;

    use super::*;
    use crate::inference::student_logits;
    use evaluation::inference::integer_logits;

    #[test]
    fn the_float_student_computes_what_the_file_does() {
        let dimensions = Dimensions {
            other: true,
            ..Dimensions::new(Vocabulary::Three, 32, 2, 11)
        };
        let parts = random_model(dimensions, 3);
        let device = Device::default();
        let (student, _) = dequantize(&parts, &device);
        let file = parts.to_bytes().unwrap();
        let emg: Vec<[u8; CHANNELS]> = (0..900_usize)
            .map(|at| std::array::from_fn(|channel| (at * (channel + 3) % 97) as u8))
            .collect();
        let float = student_logits(&student, &emg, &device);
        let integer = integer_logits(&Model::parse(&file).unwrap(), &emg).unwrap();
        assert_eq!(float.len(), integer.len());
        let integer = integer.as_flattened().as_flattened();
        for (float, integer) in float.as_flattened().as_flattened().iter().zip(integer) {
            assert!((float - integer).abs() < 0.02, "{float} {integer}");
        }
    }
}
