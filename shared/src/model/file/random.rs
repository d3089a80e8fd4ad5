//! Models with random weights, for tests and benchmarks.

use alloc::vec::Vec;

use super::{LayerParts, LinearParts, ModelParts, NormParts, ProvenanceParts, SmootherDefaults};
use crate::arithmetic::inverse_square_root;
use crate::intent::Vocabulary;
use crate::model::dimensions::{Companding, Dimensions, HEADS};
use crate::model::noise::Noise;
use crate::stream::alignment::Template;
use crate::stream::preprocess::{Median, Preprocessing};
use crate::stream::smoother::{AggregationMode, Margins};
use crate::units::{CHANNELS, LOOK_BACK, PATCH};

/// Small dimensions.
pub const SMALL: Dimensions = Dimensions::new(Vocabulary::Three, 16, 1, 5);

/// Draws tensors.
struct Draw(Noise);

impl Draw {
    fn vector(&mut self, length: usize, size: f32, about: f32) -> Vec<f32> {
        (0..length)
            .map(|_| about + size * self.0.signed())
            .collect()
    }

    /// Rows of about unit gain.
    fn linear(&mut self, outputs: usize, inputs: usize) -> LinearParts {
        let size = 2.0 * inverse_square_root(inputs as f32);
        LinearParts::quantized(
            &self.vector(outputs * inputs, size, 0.0),
            self.vector(outputs, 0.3, 0.0),
        )
    }

    fn norm(&mut self, width: usize) -> NormParts {
        NormParts {
            gain: self.vector(width, 0.5, 1.0),
            bias: self.vector(width, 0.2, 0.0),
        }
    }
}

/// A template of a pattern that falls round the arm, 2 nats per square octave in every direction.
fn ramp() -> Template {
    let mean = core::array::from_fn(|electrode| 400 - 115 * electrode as i16);
    Template::round(mean, 2).expect("means below 8 octaves, a positive diagonal")
}

/// A model of these dimensions whose weights are pseudo-random numbers from a seed.
#[must_use]
pub fn random_model(dimensions: Dimensions, seed: u64) -> ModelParts {
    let mut noise = Draw(Noise(seed));
    let Dimensions {
        width,
        layers,
        span,
        ..
    } = dimensions;
    ModelParts {
        dimensions,
        companding: Companding::SquareRoot,
        preprocessing: Preprocessing {
            normalized: seed.is_multiple_of(2),
            median: if seed.is_multiple_of(3) {
                Median::Off
            } else {
                Median::Three
            },
        },
        smoother: SmootherDefaults {
            aggregation: AggregationMode::AllRowsFrom,
            look_ahead: 50,
            hold: 20,
            margins: Margins {
                entry: 0.5,
                other: dimensions.other.then_some(0.25),
                early: None,
            },
        },
        template: Some(ramp()),
        provenance: ProvenanceParts {
            data_sets: ["noise".into(), "more noise".into()].into(),
            subjects_seen: ["noise/1".into(), "noise/2".into()].into(),
            subjects_left_out: ["noise/3".into()].into(),
            git_revision: "0123abc".into(),
            seed,
            metrics: [("raw accuracy".into(), 0.75)].into(),
        },
        embed: noise.linear(width, PATCH * CHANNELS),
        layers: (0..layers)
            .map(|_| LayerParts {
                norm1: noise.norm(width),
                qkv: noise.linear(3 * width, width),
                relative_bias: noise.vector(HEADS * span, 1.0, 0.0),
                out: noise.linear(width, width),
                norm2: noise.norm(width),
                ff1: noise.linear(2 * width, width),
                ff2: noise.linear(width, 2 * width),
            })
            .collect(),
        final_norm: noise.norm(width),
        head: noise.linear(LOOK_BACK * dimensions.row_outputs(), width),
    }
}
