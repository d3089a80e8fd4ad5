//! Reads a file into a student that owns its tensors, and writes it with another template, operating point or head.

use alloc::{borrow::ToOwned, string::String, vec::Vec};

use super::error::ModelError;
use super::header::List;
use super::layout::{LinearWeights, NormWeights};
use super::reader::Model;
use super::writer::{LayerParts, LinearParts, ModelParts, NormParts, ProvenanceParts};
use crate::kernels::WEIGHT_ONE;
use crate::kernels::packing::{unpacked, weights_of_row};
use crate::model::head::Head;
use crate::stream::alignment::{Alignment, Template};
use crate::stream::smoother::{Margins, Reaction};
use crate::units::{CHANNELS, PATCH};

impl Model<'_> {
    /// The model with tensors of its own: [`ModelParts::to_bytes`] gives the same file again, byte for byte.
    #[must_use]
    pub fn to_parts(&self) -> ModelParts {
        let header = &self.header;
        let width = header.dimensions.width;
        let provenance = &header.provenance;
        let layers = &self.weights.layers[..header.dimensions.layers];
        ModelParts {
            dimensions: header.dimensions,
            companding: header.companding,
            preprocessing: header.preprocessing,
            smoother: header.smoother,
            template: header.template,
            provenance: ProvenanceParts {
                data_sets: texts(provenance.data_sets),
                subjects_seen: texts(provenance.subjects_seen),
                subjects_left_out: texts(provenance.subjects_left_out),
                git_revision: provenance.git_revision.to_owned(),
                seed: provenance.seed,
                metrics: provenance
                    .metrics
                    .iter()
                    .map(|(name, value)| (name.to_owned(), value))
                    .collect(),
            },
            embed: linear(&self.weights.embed, PATCH * CHANNELS),
            layers: layers
                .iter()
                .map(|layer| LayerParts {
                    norm1: norm(&layer.norm1),
                    qkv: linear(&layer.qkv, width),
                    relative_bias: layer.relative_bias.to_vec(),
                    out: linear(&layer.out, width),
                    norm2: norm(&layer.norm2),
                    ff1: linear(&layer.ff1, width),
                    ff2: linear(&layer.ff2, 2 * width),
                })
                .collect(),
            final_norm: norm(&self.weights.final_norm),
            head: linear(&self.weights.head, width),
        }
    }
}

impl Model<'_> {
    /// The file with another alignment template, or with none; everything else is as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`].
    pub fn with_template(file: &[u8], template: Option<&Template>) -> Result<Vec<u8>, ModelError> {
        let mut parts = Model::parse(file)?.to_parts();
        parts.template = template.copied();
        parts.to_bytes()
    }

    /// The file with another operating point: a reaction, then the margin of every class but relax, and that over movement
    /// outside the vocabulary, which only a model that knows such movement has. `None` leaves a value as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`], and [`ModelError::NoOther`].
    pub fn with_gate(
        file: &[u8],
        entry: Option<f32>,
        other: Option<f32>,
        reaction: Option<Reaction>,
    ) -> Result<Vec<u8>, ModelError> {
        let mut parts = Model::parse(file)?.to_parts();
        if other.is_some() && !parts.dimensions.other {
            return Err(ModelError::NoOther);
        }
        let own = parts.smoother.margins;
        let base = reaction.map_or(own, Reaction::margins);
        parts.smoother.margins = Margins {
            entry: entry.unwrap_or(base.entry),
            other: own.other.and(other.or(base.other)),
            early: base.early,
        };
        parts.to_bytes()
    }

    /// The file with another look-back head; everything else is as it was.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`], and [`ModelError::OtherHead`] if the head is one for other dimensions.
    pub fn with_head(file: &[u8], head: &Head) -> Result<Vec<u8>, ModelError> {
        let mut parts = Model::parse(file)?.to_parts();
        if !head.fits(&parts.dimensions) {
            return Err(ModelError::OtherHead);
        }
        parts.head = linear(&head.linear(), parts.dimensions.width);
        parts.to_bytes()
    }
}

impl ModelParts {
    /// Makes the model that gives for an armband what this one gives for the armband so aligned.
    pub fn align(&mut self, alignment: Alignment) {
        if alignment == Alignment::NONE {
            return;
        }
        let mut weights = self.embed.dequantized();
        for sample in weights.as_chunks_mut::<CHANNELS>().0 {
            *sample = alignment.inverse().apply(*sample);
        }
        let bias = core::mem::take(&mut self.embed.bias);
        self.embed = LinearParts::quantized(&weights, bias);
        self.template = self.template.map(|own| own.seen_through(alignment));
    }
}

impl LinearParts {
    /// The weights as numbers, row-major `[outputs][inputs]`.
    ///
    /// [`LinearParts::quantized`] makes weights of them again that are within half a byte's unit of these.
    #[must_use]
    pub fn dequantized(&self) -> Vec<f32> {
        let columns = self.weights.len().checked_div(self.scales.len());
        let rows = self.weights.chunks(columns.unwrap_or(0).max(1));
        rows.zip(&self.scales)
            .flat_map(|(row, &scale)| {
                let weights = weights_of_row(row).into_iter();
                weights.map(move |weight| f32::from(weight) / WEIGHT_ONE as f32 * scale)
            })
            .collect()
    }
}

fn linear(weights: &LinearWeights<'_>, inputs: usize) -> LinearParts {
    LinearParts {
        weights: unpacked(weights.weights, weights.bias.len(), inputs),
        scales: weights.scales.to_vec(),
        bias: weights.bias.to_vec(),
    }
}

fn texts<'m>(list: List<'m, &'m str>) -> Vec<String> {
    list.iter().map(ToOwned::to_owned).collect()
}

fn norm(weights: &NormWeights<'_>) -> NormParts {
    NormParts {
        gain: weights.gain.to_vec(),
        bias: weights.bias.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intent::Vocabulary;
    use crate::model::dimensions::Dimensions;
    use crate::model::encoder::HostEncoder;
    use crate::model::file::random::random_model;
    use crate::stream::alignment::Profile;
    use crate::units::Patch;

    fn parts() -> ModelParts {
        let dimensions = Dimensions {
            other: true,
            ..Dimensions::new(Vocabulary::Five, 24, 2, 9)
        };
        let mut parts = random_model(dimensions, 11);
        parts.preprocessing.normalized = true;
        parts.provenance.subjects_seen = ["a/1", "b/2"].map(ToOwned::to_owned).to_vec();
        parts.provenance.metrics = [("a raw accuracy".to_owned(), 0.5)].to_vec();
        parts
    }

    #[test]
    fn a_file_taken_apart_and_written_again_is_the_same_file() {
        let parts = parts();
        let file = parts.to_bytes().unwrap();
        let again = Model::parse(&file).unwrap().to_parts();
        assert_eq!(again, parts);
        assert_eq!(again.to_bytes().unwrap(), file);
    }

    #[test]
    fn an_aligned_model_gives_for_an_armband_what_the_model_gives_for_it_aligned() {
        let profile = Profile::new([9, 80, 700, 300, 60, 20, 500, 90]);
        let patch: Patch =
            core::array::from_fn(|at| core::array::from_fn(|to| (at * 31 + to * 47) as u8 % 129));
        for alignment in Alignment::all() {
            let mut parts = parts();
            let files = [parts.clone(), {
                parts.align(alignment);
                parts
            }];
            let files = files.map(|own| own.to_bytes().unwrap());
            let [model, aligned] = files.each_ref().map(|own| Model::parse(own).unwrap());
            let [nearest, found] = [&model, &aligned].map(|own| own.header.template.unwrap());
            assert_eq!(
                found.fit(profile).nearest.distance,
                nearest.fit(profile).nearest.distance
            );
            let logits = |model: &Model<'_>, patch: &Patch| {
                let encoder = HostEncoder::new(model).unwrap();
                encoder.step(&mut encoder.fresh(), patch)
            };
            let expected = logits(&model, &patch.map(|own| alignment.apply(own)));
            for (row, found) in expected.iter().zip(&logits(&aligned, &patch)) {
                for (logit, found) in row.iter().zip(found) {
                    assert!(
                        (logit - found).abs() < 0.05,
                        "{logit} {found} {alignment:?}"
                    );
                }
            }
        }
    }
}
