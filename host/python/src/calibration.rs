//! Calibration of a model by a person's own holds.

use std::path::PathBuf;

use evaluation::calibration::calibrate_file;
use evaluation::model_evaluation::NamedModel;
use pyo3::prelude::*;

use crate::failure::told;
use crate::model::Model;
use crate::recording::library;

/// Result of a calibration on one person's holds.
#[pyclass(frozen, get_all, module = "myointent")]
pub struct Calibration {
    /// The person, as `data-set/person`.
    person: String,
    /// Rounds that were shown: holds of each gesture.
    rounds: usize,
    /// Whether other movement was shown too.
    other_movement: bool,
    /// Mean recall of the old last layer in the later half of the rounds.
    before: f32,
    /// Mean recall there of the new one, learnt from the earlier half.
    after: f32,
    /// Model with the new last layer, learnt from all rounds; None if the old one is better: go on with it.
    model: Option<Py<Model>>,
}

#[pymethods]
impl Calibration {
    fn __repr__(&self) -> String {
        let Self {
            person,
            rounds,
            before,
            after,
            ..
        } = self;
        format!("<Calibration {person}: {rounds} rounds, recall {before:.3} -> {after:.3}>")
    }
}

/// Learns a model's last layer from one person's labelled holds, as `myointent calibrate` does.
///
/// Raises `Error` if the recordings hold too little of a class, or are of several people and no person is named.
///
/// Args:
///     model: The model.
///     path: Folder, file or description of the recordings, as `read` takes it.
///     person: Person, as `data-set/person` or `person` alone; needed if the recordings are of several.
///     show_others: Show six seconds of labelled other movement too: it raises fewer labels then, and so do gestures.
///     strict: Refuse damaged files instead of leaving them out.
///     as_recorded: Leave the channels of published sets in their own order instead of turning them into the frame of the
///         models.
#[pyfunction]
#[pyo3(signature = (model, path, *, person = None, show_others = false, strict = false, as_recorded = false))]
pub fn calibrate(
    py: Python<'_>,
    model: &Model,
    path: PathBuf,
    person: Option<&str>,
    show_others: bool,
    strict: bool,
    as_recorded: bool,
) -> PyResult<Calibration> {
    let library = library(py, &path, strict, as_recorded)?;
    let named = &model.named;
    let done = py
        .detach(|| calibrate_file(&named.bytes, &library, person, show_others))
        .map_err(told)?;
    let calibrated = |bytes| {
        let name = format!("{} of {}", named.name, done.subject);
        Py::new(py, model.with(NamedModel::new(&name, bytes)))
    };
    let [before, after] = done.recalls;
    Ok(Calibration {
        model: done.file.map(calibrated).transpose()?,
        person: done.subject,
        rounds: done.rounds,
        other_movement: done.others,
        before,
        after,
    })
}
