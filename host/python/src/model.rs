//! Model files, and their labels of whole recordings.

use std::path::PathBuf;
use std::sync::Arc;

use evaluation::inference::{input, integer_logits};
use evaluation::model_evaluation::NamedModel;
use evaluation::smooth;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple, PyType};
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file;

use crate::arrays::{classes, with_samples};
use crate::failure::{about, told};

/// Labels and logits of a recording.
type Prediction<'py> = (Bound<'py, PyArray1<i8>>, Bound<'py, PyArray2<f32>>);

/// A model file (`.intent`), the one that a board runs.
///
/// Args:
///     file: Path of a model file, or its content as bytes.
///     name: Name in tables; that of the file without its ending if not given.
///
/// Raises `Error` if the file cannot be read or is refused.
#[pyclass(frozen, module = "myointent")]
pub struct Model {
    /// The file's content and its name in tables.
    pub named: Arc<NamedModel>,
    classes: &'static [Intent],
}

impl Model {
    /// Another file of a model with the same classes.
    pub fn with(&self, named: NamedModel) -> Self {
        Self {
            named: Arc::new(named),
            classes: self.classes,
        }
    }
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (file, name = None))]
    fn new(file: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Self> {
        let (path, mut named) = match file.cast::<PyBytes>() {
            Ok(content) => {
                let bytes = content.as_bytes().to_vec();
                (PathBuf::from("model"), NamedModel::new("model", bytes))
            }
            Err(_) => {
                let path: PathBuf = file.extract()?;
                let named = NamedModel::read(&path).map_err(about(&path))?;
                (path, named)
            }
        };
        if let Some(name) = name {
            named = NamedModel::new(&name, named.bytes);
        }
        let refused = PathBuf::from(format!("{} is refused", path.display()));
        let model = file::Model::parse(&named.bytes);
        let model = model.and_then(|model| HostEncoder::new(&model).map(|_| model));
        let classes = model
            .map_err(about(&refused))?
            .header
            .dimensions
            .vocabulary
            .intents();
        Ok(Self {
            named: Arc::new(named),
            classes,
        })
    }

    /// A model is pickled as the content of its file.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyType>, (Bound<'py, PyBytes>, &str)) {
        (py.get_type::<Self>(), (self.content(py), &self.named.name))
    }

    /// Name of the file without its ending.
    #[getter]
    fn name(&self) -> &str {
        &self.named.name
    }

    /// Content of the file, to be written or installed.
    #[getter]
    fn content<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.named.bytes)
    }

    /// Names of the classes, in the order of their numbers and of the logits' columns.
    #[getter]
    fn classes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.classes.iter().map(|intent| intent.name()))
    }

    /// Labels a whole recording, as `myointent predict` does.
    ///
    /// Args:
    ///     emg: Raw samples as the armband sends them, shape (n, 8), whole numbers from -128 to 127, 200 Hz. An int8
    ///         array in C order is not copied.
    ///     emitted: Each label from the time on at which a board emits it, instead of the time that it is for.
    ///
    /// Returns:
    ///     labels: int8, shape (n,): class number of each sample; -1 before the first label and, unless `emitted`, for
    ///         the last samples, whose label needs samples after them.
    ///     logits: float32, shape (n // 10, classes): of each patch of 10 samples (50 ms) when it was the newest.
    #[pyo3(signature = (emg, *, emitted = false))]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        emg: &Bound<'py, PyAny>,
        emitted: bool,
    ) -> PyResult<Prediction<'py>> {
        with_samples(emg, |samples| {
            let model = file::Model::parse(&self.named.bytes).map_err(told)?;
            let emg = input(samples, model.header.preprocessing);
            let rows = integer_logits(&model, &emg).map_err(told)?;
            let (count, settings) = (self.classes.len(), model.header.smoother.in_patches());
            let labels = smooth(&rows, samples.len(), count, settings).map_err(told)?;
            let labels = if emitted {
                labels.emitted
            } else {
                labels.reference
            };
            let newest = rows.iter().flat_map(|[newest, ..]| &newest[..count]);
            let logits = PyArray1::from_iter(py, newest.copied()).reshape([rows.len(), count])?;
            Ok((classes(py, &labels), logits))
        })
    }

    fn __repr__(&self) -> String {
        let classes: Vec<&str> = self.classes.iter().map(|intent| intent.name()).collect();
        format!("<Model {}: {}>", self.named.name, classes.join(", "))
    }
}
