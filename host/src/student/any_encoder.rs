//! The device's encoder for whatever shape a model file has.
//!
//! On the device the shape is a type; the host meets models of several shapes and chooses among
//! the compiled ones at run time.

use shared::{
    encoder::{Encoder, Logits, Patch, usual_span},
    model_file::{Dimensions, Model, ModelError},
    pipeline::Encode,
};

/// Why a model cannot run on this host.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum AnyEncoderError {
    /// A good model of a shape that nothing is compiled for.
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

/// What wants the encoder of a model as a type: a pipeline, for instance.
pub trait WithEncoder<'m> {
    /// What comes of it.
    type Output;

    /// Goes on with the encoder.
    fn run<E: Encode<State: Send> + Send + 'm>(self, encoder: E) -> Self::Output;
}

/// Runs `task` with the encoder of the model's shape.
///
/// # Errors
///
/// If nothing is compiled for that shape.
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

/// An encoder and its memory, the shape hidden.
pub trait AnyEncoder: Send {
    /// Number of classes, 3 or 6.
    fn classes(&self) -> usize;

    /// Forgets the stream so far.
    fn reset(&mut self);

    /// Takes the next patch and gives the scores of the six newest, newest first.
    fn step(&mut self, patch: &Patch) -> Logits;
}

/// The encoder of a model, whatever its shape, with a fresh memory.
///
/// # Errors
///
/// As [`with_encoder`].
pub fn any_encoder<'m>(model: &Model<'m>) -> Result<Box<dyn AnyEncoder + 'm>, AnyEncoderError> {
    with_encoder(model, Boxed)
}

struct Boxed;

impl<'m> WithEncoder<'m> for Boxed {
    type Output = Box<dyn AnyEncoder + 'm>;

    fn run<E: Encode<State: Send> + Send + 'm>(self, encoder: E) -> Self::Output {
        let state = encoder.fresh();
        Box::new(Running { encoder, state })
    }
}

struct Running<E: Encode> {
    encoder: E,
    state: E::State,
}

impl<E: Encode<State: Send> + Send> AnyEncoder for Running<E> {
    fn classes(&self) -> usize {
        self.encoder.classes()
    }

    fn reset(&mut self) {
        self.encoder.reset(&mut self.state);
    }

    fn step(&mut self, patch: &Patch) -> Logits {
        self.encoder.step(&mut self.state, patch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::{intent::Vocabulary, model_file::samples::random_model};

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

    fn patches() -> impl Iterator<Item = Patch> {
        (0..40).map(|step| {
            let mut patch = Patch::default();
            patch
                .as_flattened_mut()
                .iter_mut()
                .enumerate()
                .for_each(|(index, value)| {
                    *value = ((index * 37 + step * 11) % 129) as u8;
                });
            patch
        })
    }

    #[test]
    fn the_boxed_encoder_is_the_typed_one_and_forgets_on_reset() {
        let bytes = model_bytes(64, 2, 27);
        let model = Model::parse(&bytes).unwrap();
        let typed = Encoder::<64, 2, 27>::new(&model).unwrap();
        let mut boxed = any_encoder(&model).unwrap();
        assert_eq!(boxed.classes(), 6);
        for _ in 0..2 {
            boxed.reset();
            let mut state = typed.fresh();
            for patch in patches() {
                assert_eq!(boxed.step(&patch), typed.step(&mut state, &patch));
            }
        }
    }

    #[test]
    fn every_listed_shape_runs_and_another_is_refused() {
        for width in [48, 64, 96, 128] {
            for layers in [2, 3] {
                let bytes = model_bytes(width, layers, usual_span(layers));
                assert!(any_encoder(&Model::parse(&bytes).unwrap()).is_ok());
            }
        }
        let bytes = model_bytes(64, 2, 20);
        let model = Model::parse(&bytes).unwrap();
        let refused = any_encoder(&model).err().unwrap();
        assert_eq!(refused, AnyEncoderError::Shape(model.header.dimensions));
    }
}
