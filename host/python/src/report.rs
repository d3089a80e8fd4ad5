//! Results with numbers for programs and text for people.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::failure::told;

/// Scores: `results` for programs, `str()` or `print` for people.
#[pyclass(frozen, module = "myointent")]
pub struct Report {
    results: Py<PyDict>,
    text: String,
}

impl Report {
    /// A report of results that have a form in JSON.
    pub fn new(py: Python<'_>, results: &impl Serialize, text: String) -> PyResult<Self> {
        let json = serde_json::to_string(results).map_err(told)?;
        let results = py.import("json")?.call_method1("loads", (json,))?;
        let results = results.cast_into::<PyDict>()?.unbind();
        Ok(Self { results, text })
    }
}

#[pymethods]
impl Report {
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
