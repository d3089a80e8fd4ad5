//! The header of a model: dimensions, defaults of the smoother, provenance.

use core::marker::PhantomData;

use serde::Deserialize;

use super::error::ModelError;
use crate::model::dimensions::{Companding, Dimensions};
use crate::stream::alignment::Template;
use crate::stream::preprocess::Preprocessing;
use crate::stream::smoother::{AggregationMode, Margins, Settings};
use crate::units::PATCH;

/// Default settings of the smoother for a model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SmootherDefaults {
    /// Rows that are summed.
    pub aggregation: AggregationMode,
    /// Samples of look-ahead: whole patches, at most 50.
    pub look_ahead: usize,
    /// Samples that a label is held: whole patches, at least one, at most [`MAX_HOLD`](crate::units::MAX_HOLD).
    pub hold: usize,
    /// Margins of a label, at most [`MAX_ENTRY_MARGIN`](crate::units::MAX_ENTRY_MARGIN), none but that over movement outside
    /// the vocabulary below 0; that one is `None` if the model does not know such movement.
    pub margins: Margins,
}

impl SmootherDefaults {
    /// The settings of a smoother with one row per patch.
    #[must_use]
    pub const fn in_patches(&self) -> Settings {
        Settings {
            aggregation: self.aggregation,
            look_ahead: self.look_ahead / PATCH,
            hold: self.hold / PATCH,
            margins: self.margins,
            ..Settings::PAPER_IN_PATCHES
        }
    }
}

/// Provenance of a model.
#[derive(Clone, Copy, Debug)]
pub struct Provenance<'m> {
    /// Names of the data sets.
    pub data_sets: List<'m, &'m str>,
    /// Subjects whom this model, or any model that its training started from, was trained on or validated with, as
    /// `data set/subject`.
    pub subjects_seen: List<'m, &'m str>,
    /// Subjects left out of the training, as `data set/subject`.
    pub subjects_left_out: List<'m, &'m str>,
    /// Revision of the training program.
    pub git_revision: &'m str,
    /// Random seed of the training.
    pub seed: u64,
    /// Name and value of measured metrics.
    pub metrics: List<'m, (&'m str, f32)>,
}

/// The header of a model.
#[derive(Clone, Copy, Debug)]
pub struct Header<'m> {
    /// Dimensions of the tensors.
    pub dimensions: Dimensions,
    /// Companding of the input.
    pub companding: Companding,
    /// Processing between the armband and the input.
    pub preprocessing: Preprocessing,
    /// Default settings of the smoother.
    pub smoother: SmootherDefaults,
    /// Pattern of an open hand, for alignment; none if nobody in the training data opens it.
    pub template: Option<Template>,
    /// Provenance.
    pub provenance: Provenance<'m>,
}

/// A borrowed list: postcard items one after another.
#[derive(Clone, Copy, Debug)]
pub struct List<'m, T> {
    bytes: &'m [u8],
    item: PhantomData<T>,
}

impl<'m, T: Deserialize<'m>> List<'m, T> {
    pub(super) fn read(bytes: &'m [u8], field: &'static str) -> Result<Self, ModelError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            (_, rest) =
                postcard::take_from_bytes::<T>(rest).map_err(|_| ModelError::Header { field })?;
        }
        Ok(Self {
            bytes,
            item: PhantomData,
        })
    }

    /// The items in order.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<'m, T> {
        let mut rest = self.bytes;
        core::iter::from_fn(move || {
            // `read` has parsed all items; an empty rest is the end.
            let (item, after) = postcard::take_from_bytes(rest).ok()?;
            rest = after;
            Some(item)
        })
    }
}
