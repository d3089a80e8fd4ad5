//! Surroundings of the network, for a program that computes the network itself: the patches that it takes, and the labels
//! that its logits mean.

use numpy::PyUntypedArrayMethods as _;
use numpy::{PyArray1, PyArray3, PyArrayMethods as _, PyReadonlyArray2};
use pyo3::prelude::*;
use shared::intent::Intent;
use shared::model::LookBackLogits;
use shared::model::file;
use shared::pipeline;
use shared::stream::normalizer::Normalizer;
use shared::stream::preprocess::{DIVISOR, Preprocessor};
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, SampleIndex, WINDOW_PATCHES};

use crate::arrays::with_samples;
use crate::failure::{shape, told};
use crate::model::Model;

/// The patches that a model's network takes, of one stream from its start on: normalized to the wearer and filtered if the
/// model was trained so, rectified, over 128.
///
/// Args:
///     model: The model.
#[pyclass(module = "myointent")]
pub struct Patches {
    normalizer: Option<Normalizer>,
    preprocessor: Preprocessor,
    /// Samples of the incomplete patch.
    rest: Vec<CleanSample>,
}

#[pymethods]
impl Patches {
    #[new]
    fn new(model: &Model) -> PyResult<Self> {
        let model = file::Model::parse(&model.named.bytes).map_err(told)?;
        let preprocessing = model.header.preprocessing;
        Ok(Self {
            normalizer: preprocessing.normalized.then(Normalizer::default),
            preprocessor: Preprocessor::new(preprocessing.median),
            rest: Vec::new(),
        })
    }

    /// Takes the next samples and returns the patches that they complete.
    ///
    /// Args:
    ///     samples: Raw samples as `Stream.push` takes them, shape (n, 8).
    ///
    /// Returns:
    ///     float32, shape (patches, 10, 8). A patch is complete with the sample after its last one.
    fn push<'py>(
        &mut self,
        py: Python<'py>,
        samples: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        with_samples(samples, |samples| {
            self.rest.extend(samples.iter().filter_map(|&sample| {
                let normalizer = self.normalizer.as_mut();
                let sample = normalizer.map_or(sample, |wearer| wearer.push(sample));
                self.preprocessor.push(sample)
            }));
            let (patches, rest) = self.rest.as_chunks::<PATCH>();
            let values = patches.as_flattened().as_flattened().iter();
            let values = values.map(|&value| f32::from(value) / f32::from(DIVISOR));
            let array = PyArray1::from_iter(py, values).reshape([patches.len(), PATCH, CHANNELS]);
            self.rest = rest.to_vec();
            array
        })
    }
}

/// The labels that the logits of a model's network mean, of one stream from its start on: look-ahead, hold and the
/// confidence gate of the model. No label comes before a window of 60 patches is full.
///
/// Args:
///     model: The model.
#[pyclass(module = "myointent")]
pub struct Smoother {
    smoother: pipeline::Smoother,
    columns: usize,
    /// Patches so far.
    patches: u32,
}

#[pymethods]
impl Smoother {
    #[new]
    fn new(model: &Model) -> PyResult<Self> {
        let model = file::Model::parse(&model.named.bytes).map_err(told)?;
        let dimensions = model.header.dimensions;
        let settings = model.header.smoother.in_patches();
        let classes = dimensions.vocabulary.classes();
        Ok(Self {
            smoother: pipeline::Smoother::new(settings, classes).map_err(told)?,
            columns: dimensions.row_outputs(),
            patches: 0,
        })
    }

    /// Takes the logits of the next patch; returns the label that is due.
    ///
    /// Args:
    ///     logits: float32, shape (6, columns): rows for the six newest patches, the newest first; the columns are the
    ///         classes and, for a model that knows it, other movement.
    ///
    /// Returns:
    ///     The index of the sample that the label is for, and the label; None where no label is due.
    fn push(&mut self, logits: PyReadonlyArray2<'_, f32>) -> PyResult<Option<(u32, &'static str)>> {
        if logits.shape() != [LOOK_BACK, self.columns] {
            let expected = format!("an array of {LOOK_BACK} x {} logits", self.columns);
            return Err(shape(&expected, logits.shape()));
        }
        let mut rows = LookBackLogits::default();
        for (row, logits) in rows.iter_mut().zip(logits.as_array().rows()) {
            row.iter_mut()
                .zip(logits)
                .for_each(|(to, from)| *to = *from);
        }
        self.patches = self.patches.wrapping_add(1);
        if (self.patches as usize) < WINDOW_PATCHES {
            return Ok(None);
        }
        let end = SampleIndex(self.patches.wrapping_mul(PATCH as u32).wrapping_sub(1));
        let decision = self.smoother.push(end, &rows);
        Ok(decision.and_then(|decision| {
            let intent = Intent::from_class(decision.class)?;
            Some((decision.instant.0, intent.name()))
        }))
    }
}
