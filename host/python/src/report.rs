//! Results with numbers for programs and text for people.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use serde::Serialize;

use crate::failure::told;

/// Scores: `results` for programs, `str()` or `print` for people.
///
/// Args:
///     results: All numbers.
///     text: Tables.
#[pyclass(frozen, module = "myointent")]
pub struct Report {
    results: Py<PyDict>,
    text: String,
}

impl Report {
    /// A report of results that have a form in JSON.
    pub fn of(py: Python<'_>, results: &impl Serialize, text: String) -> PyResult<Self> {
        let json = serde_json::to_string(results).map_err(told)?;
        let results = py.import("json")?.call_method1("loads", (json,))?;
        let results = results.cast_into::<PyDict>()?.unbind();
        Ok(Self { results, text })
    }
}

#[pymethods]
impl Report {
    #[new]
    const fn new(results: Py<PyDict>, text: String) -> Self {
        Self { results, text }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (Bound<'py, PyDict>, &str)) {
        let results = self.results.bind(py).clone();
        (py.get_type::<Self>(), (results, &self.text))
    }

    /// All numbers, by the names that the program's `--json` has; docs/metrics.md defines them.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> &Bound<'py, PyDict> {
        self.results.bind(py)
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}
