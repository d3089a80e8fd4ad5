//! The encoder of whichever shape the model file has, as a device needs it: no heap to choose on,
//! and one memory for all of them.
//!
//! Each shape is compiled by itself and the file chooses. Wider models than these exist on the
//! host; they fit neither a device's model region (160 KiB) nor its time.

use super::{Encoder, EncoderState, Logits, Patch};
use crate::model::file::{Model, ModelError};
use crate::pipeline::Encode;

macro_rules! shapes {
    ($($(#[$note:meta])* $name:ident ($width:literal, $layers:literal, $span:literal)),* $(,)?) => {
        /// Width, layers and span of every shape that [`AnyShape`] runs.
        pub const SHAPES: &[(usize, usize, usize)] = &[$(($width, $layers, $span)),*];

        /// An encoder of one of [`SHAPES`].
        #[derive(Clone, Copy, Debug)]
        #[allow(clippy::large_enum_variant, reason = "there is one, and no heap to box it on")]
        pub enum AnyShape<'m> {
            $($(#[$note])* $name(Encoder<'m, $width, $layers, $span>),)*
        }

        /// What the encoder remembers; room for the largest shape.
        #[derive(Clone, Debug)]
        pub enum AnyState {
            $($(#[$note])* $name(EncoderState<$width, $layers, $span>),)*
        }

        impl<'m> AnyShape<'m> {
            /// The encoder of a model.
            ///
            /// # Errors
            ///
            /// [`ModelError::ShapeNotCompiled`] if the shape is none of [`SHAPES`].
            pub fn new(model: &Model<'m>) -> Result<Self, ModelError> {
                let dimensions = &model.header.dimensions;
                let (width, layers, span) = (dimensions.width, dimensions.layers, dimensions.span);
                match (width, layers, span) {
                    $(($width, $layers, $span) => Encoder::new(model).map(Self::$name),)*
                    _ => Err(ModelError::ShapeNotCompiled { width, layers, span }),
                }
            }

            /// Makes the state one of this shape, in place: written so that no second state lies on
            /// the stack, where a device has no room for it.
            #[inline(never)]
            fn reshape(&self, state: &mut AnyState) {
                match self {
                    $(Self::$name(_) => *state = AnyState::$name(EncoderState::fresh()),)*
                }
            }
        }

        impl Encode for AnyShape<'_> {
            type State = AnyState;

            fn classes(&self) -> usize {
                match self {
                    $(Self::$name(encoder) => encoder.classes(),)*
                }
            }

            fn fresh(&self) -> AnyState {
                match self {
                    $(Self::$name(_) => AnyState::$name(EncoderState::fresh()),)*
                }
            }

            fn reset(&self, state: &mut AnyState) {
                match (self, &mut *state) {
                    $((Self::$name(_), AnyState::$name(state)) => state.reset(),)*
                    // Of another shape: happens once, when the model is chosen.
                    _ => self.reshape(state),
                }
            }

            fn step(&self, state: &mut AnyState, patch: &Patch) -> Logits {
                loop {
                    match (self, &mut *state) {
                        $((Self::$name(encoder), AnyState::$name(state)) => {
                            break encoder.step(state, patch);
                        })*
                        // A state of another shape holds nothing of this stream.
                        _ => self.reshape(state),
                    }
                }
            }
        }
    };
}

shapes! {
    /// Width 64, two layers: the usual student.
    W64L2(64, 2, 27),
    /// Width 48, two layers: less flash, less time.
    W48L2(48, 2, 27),
    /// Width 64, three layers: the same memory, half as much time again.
    W64L3(64, 3, 18),
}

impl AnyState {
    /// Remembers nothing; the memory of a device before it has read its model.
    pub const EMPTY: Self = Self::W64L2(EncoderState::fresh());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intent::Vocabulary;
    use crate::model::file::{
        Dimensions,
        samples::{Noise, random_model},
    };
    use alloc::vec::Vec;

    fn file(width: usize, layers: usize, span: usize) -> Vec<u8> {
        let vocabulary = Vocabulary::Three;
        let dimensions = Dimensions {
            width,
            layers,
            span,
            vocabulary,
        };
        random_model(dimensions, 7).to_bytes().unwrap()
    }

    fn patches() -> impl Iterator<Item = Patch> {
        let mut noise = Noise(9);
        (0..70).map(move |_| {
            let mut patch = Patch::default();
            patch
                .as_flattened_mut()
                .fill_with(|| (noise.bits() % 129) as u8);
            patch
        })
    }

    #[test]
    fn the_file_chooses_the_encoder_whatever_the_memory_held_before() {
        let mut state = AnyState::EMPTY;
        for &(width, layers, span) in SHAPES.iter().chain(SHAPES) {
            let bytes = file(width, layers, span);
            let encoder = AnyShape::new(&Model::parse(&bytes).unwrap()).unwrap();
            encoder.reset(&mut state);
            let mut other = encoder.fresh();
            for patch in patches() {
                let expected = encoder.step(&mut other, &patch);
                assert_eq!(encoder.step(&mut state, &patch), expected);
            }
        }
    }

    #[test]
    fn the_chosen_encoder_is_the_typed_one() {
        let bytes = file(64, 3, 18);
        let model = Model::parse(&bytes).unwrap();
        let any = AnyShape::new(&model).unwrap();
        let typed = Encoder::<64, 3, 18>::new(&model).unwrap();
        let (mut state, mut typed_state) = (AnyState::EMPTY, typed.fresh());
        for patch in patches() {
            let expected = typed.step(&mut typed_state, &patch);
            assert_eq!(any.step(&mut state, &patch), expected);
        }
    }

    #[test]
    fn a_good_model_of_another_shape_is_refused() {
        let bytes = file(56, 2, 27);
        let refused = AnyShape::new(&Model::parse(&bytes).unwrap()).err();
        let expected = ModelError::ShapeNotCompiled {
            width: 56,
            layers: 2,
            span: 27,
        };
        assert_eq!(refused, Some(expected));
    }
}
