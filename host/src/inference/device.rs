//! The device's encoder for a model file of any supported shape.
//!
//! On the device the shape is a type; the host meets models of several shapes and chooses among
//! the compiled ones at run time.

use shared::model::encoder::{Encoder, Logits, Patch, usual_span};
use shared::model::file::{Dimensions, Model, ModelError};
use shared::pipeline::{Encode, LookBackLogits};
use shared::units::{CleanSample, PATCH, WINDOW_PATCHES};

use crate::dataset::lead_in::padded;

/// Why a model cannot run on this host.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum AnyEncoderError {
    /// A valid model of a shape that no encoder is compiled for.
    #[error(
        "model of width {}, {} layers, span {}; compiled are widths 48, 64, 96, 128 with 2 layers \
         and span {}, or 3 layers and span {}: train one of these",
        .0.width, .0.layers, .0.span, usual_span(2), usual_span(3)
    )]
    Shape(Dimensions),
    /// The encoder refuses the model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A computation that is generic over the encoder's shape: a pipeline, for instance.
pub trait WithEncoder<'m> {
    /// Its result.
    type Output;

    /// Runs with the encoder of the model.
    fn run<E: Encode<State: Send> + Send + 'm>(self, encoder: E) -> Self::Output;
}

/// Runs `task` with the encoder of the model's shape.
///
/// # Errors
/// When no encoder is compiled for that shape.
pub fn with_encoder<'m, T: WithEncoder<'m>>(
    model: &Model<'m>,
    task: T,
) -> Result<T::Output, AnyEncoderError> {
    let shape = model.header.dimensions;
    macro_rules! compiled {
        ($(($width:literal, $layers:literal))*) => {
            match (shape.width, shape.layers) {
                $(($width, $layers) if shape.span == usual_span($layers) => {
                    Ok(task.run(Encoder::<'m, $width, $layers, { usual_span($layers) }>::new(model)?))
                })*
                _ => Err(AnyEncoderError::Shape(shape)),
            }
        };
    }
    compiled! {
        (48, 2) (64, 2) (96, 2) (128, 2)
        (48, 3) (64, 3) (96, 3) (128, 3)
    }
}

/// Logits after each of the patches of a stream, from its beginning.
fn outputs(model: &Model<'_>, patches: &[Patch]) -> Result<Vec<Logits>, AnyEncoderError> {
    with_encoder(model, Outputs(patches))
}

struct Outputs<'p>(&'p [Patch]);

impl<'m> WithEncoder<'m> for Outputs<'_> {
    type Output = Vec<Logits>;

    fn run<E: Encode<State: Send> + Send + 'm>(self, encoder: E) -> Self::Output {
        let Self(patches) = self;
        let mut outputs = Vec::with_capacity(patches.len());
        let mut state = encoder.fresh();
        encoder.steps(&mut state, patches, |logits| outputs.push(logits));
        outputs
    }
}

/// Logits of an integer student at every whole patch of a recording, as the device computes them, after a
/// lead-in of one window.
///
/// # Errors
/// When no encoder is compiled for the model's shape.
pub fn integer_logits(
    model: &Model<'_>,
    emg: &[CleanSample],
) -> Result<Vec<LookBackLogits>, AnyEncoderError> {
    let stream = padded(emg);
    let (patches, _) = stream.as_chunks::<PATCH>();
    Ok(outputs(model, patches)?
        .into_iter()
        .skip(WINDOW_PATCHES)
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::intent::Vocabulary;
    use shared::model::file::samples::random_model;

    fn model_bytes(width: usize, layers: usize, span: usize) -> Vec<u8> {
        let vocabulary = Vocabulary::Six;
        let dimensions = Dimensions {
            width,
            layers,
            span,
            vocabulary,
        };
        random_model(dimensions, 5).to_bytes().unwrap()
    }

    #[test]
    fn the_outputs_are_those_of_the_typed_encoder_step_by_step() {
        let bytes = model_bytes(64, 2, usual_span(2));
        let model = Model::parse(&bytes).unwrap();
        let typed = Encoder::<64, 2, { usual_span(2) }>::new(&model).unwrap();
        let patches: Vec<Patch> = (0..39)
            .map(|step| {
                let mut patch = Patch::default();
                for (index, value) in patch.as_flattened_mut().iter_mut().enumerate() {
                    *value = ((index * 37 + step * 11) % 129) as u8;
                }
                patch
            })
            .collect();
        let mut state = typed.fresh();
        let expected: Vec<Logits> = patches
            .iter()
            .map(|patch| typed.step(&mut state, patch))
            .collect();
        for count in [0, 1, 3, 4, 38, 39] {
            assert_eq!(
                outputs(&model, &patches[..count]).unwrap(),
                expected[..count]
            );
        }
    }

    #[test]
    fn every_listed_shape_runs_and_another_is_refused() {
        for width in [48, 64, 96, 128] {
            for layers in [2, 3] {
                let bytes = model_bytes(width, layers, usual_span(layers));
                assert!(outputs(&Model::parse(&bytes).unwrap(), &[]).is_ok());
            }
        }
        let bytes = model_bytes(64, 2, 20);
        let model = Model::parse(&bytes).unwrap();
        let refused = outputs(&model, &[]).err().unwrap();
        assert_eq!(refused, AnyEncoderError::Shape(model.header.dimensions));
    }
}
