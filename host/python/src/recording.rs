//! Recordings as numpy arrays.

use std::ffi::CString;
use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyType;
use recordings::labels::lag::LabelLag;
use recordings::labels::motion::{Motion, motions};
use recordings::labels::set_lag::lags;
use recordings::split::predefined;
use recordings::{Library, LoadOptions, imu, load};
use shared::units::CHANNELS;

use crate::failure::told;

/// A continuous recording of one person.
#[pyclass(frozen, get_all, module = "myointent")]
pub struct Recording {
    /// The person, as `data-set/person`.
    person: String,
    /// Name within the person's recordings.
    name: String,
    /// File of the samples.
    path: PathBuf,
    /// Raw samples as the armband sends them, published sets in the frame of the models: int8, shape (n, 8), 200 Hz.
    emg: Py<PyArray2<i8>>,
    /// Class number of each sample: int8, shape (n,); -1 where it is unknown, -2 for other movement.
    labels: Py<PyArray1<i8>>,
    /// Other movement: first sample, the one after the last, and its name.
    other_movement: Vec<(usize, usize, String)>,
    /// Known limits and doubts, a sentence each.
    notes: Vec<String>,
}

/// Parts of a recording, in the order of its fields.
type Fields = (
    String,
    String,
    PathBuf,
    Py<PyArray2<i8>>,
    Py<PyArray1<i8>>,
    Vec<(usize, usize, String)>,
    Vec<String>,
);

#[pymethods]
impl Recording {
    #[new]
    const fn of(
        person: String,
        name: String,
        path: PathBuf,
        emg: Py<PyArray2<i8>>,
        labels: Py<PyArray1<i8>>,
        other_movement: Vec<(usize, usize, String)>,
        notes: Vec<String>,
    ) -> Self {
        Self {
            person,
            name,
            path,
            emg,
            labels,
            other_movement,
            notes,
        }
    }

    /// Movement of the armband, where `record --imu` wrote it beside the file: float64, shape (m, 11): row of the file that was
    /// due, unit quaternion w, x, y, z, acceleration x, y, z in g, turn rate x, y, z in degrees a second. None without.
    #[getter]
    fn imu<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let rows = imu::read(&self.path).map_err(told)?;
        let array = |rows: Vec<[f64; imu::COLUMNS]>| {
            let shape = [rows.len(), imu::COLUMNS];
            PyArray1::from_vec(py, rows.into_flattened()).reshape(shape)
        };
        rows.map(array).transpose()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, Fields) {
        let fields = (
            self.person.clone(),
            self.name.clone(),
            self.path.clone(),
            self.emg.clone_ref(py),
            self.labels.clone_ref(py),
            self.other_movement.clone(),
            self.notes.clone(),
        );
        (py.get_type::<Self>(), fields)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let samples = self.labels.bind(py).len().unwrap_or(0);
        let seconds = samples as f64 / f64::from(shared::units::SAMPLE_RATE_HZ);
        format!("<Recording {}/{}: {seconds:.1} s>", self.person, self.name)
    }
}

impl Recording {
    fn new(py: Python<'_>, recording: recordings::Recording) -> PyResult<Self> {
        let motions = motions(&recording.labels, &recording.other_movement);
        let labels = motions.into_iter().map(Motion::number).collect();
        let rows = recording.samples.len();
        let emg = PyArray1::from_vec(py, recording.samples.into_flattened());
        let movements = recording.other_movement.into_iter();
        let findings = recording.findings.iter().map(ToString::to_string);
        Ok(Self {
            person: recording.subject,
            name: recording.name,
            path: recording.path,
            emg: emg.reshape([rows, CHANNELS])?.unbind(),
            labels: PyArray1::from_vec(py, labels).unbind(),
            other_movement: movements
                .map(|own| {
                    (
                        own.samples.start,
                        own.samples.end,
                        own.kind.name().to_owned(),
                    )
                })
                .collect(),
            notes: recording.notes.into_iter().chain(findings).collect(),
        })
    }
}

/// Reads every recording at or below a path: any layout that `myointent data inspect` reads, or that a `recordings.toml`
/// describes.
///
/// Files that are left out and doubts about recordings are warnings.
///
/// Args:
///     path: Folder, file or description.
///     strict: Refuse damaged files instead of leaving them out.
///     label_lag: Where labels are cues, move them to where the muscle acts: "none", "each-cue" or "estimated", as the
///         option `--label-lag` of `myointent evaluate`.
///     as_recorded: Leave the channels of published sets in their own order instead of turning them into the frame of the
///         models. `notes` say what was turned.
#[pyfunction]
#[pyo3(signature = (path, *, strict = false, label_lag = "none", as_recorded = false))]
pub fn read(
    py: Python<'_>,
    path: PathBuf,
    strict: bool,
    label_lag: &str,
    as_recorded: bool,
) -> PyResult<Vec<Recording>> {
    let label_lag = label_lag.parse::<LabelLag>().map_err(told)?;
    let library = library(py, &path, strict, as_recorded)?;
    let labelled: Vec<_> = library.recordings.iter().collect();
    let lags = lags(&labelled, label_lag, &predefined::is_training);
    let recordings = library.recordings.into_iter();
    recordings
        .map(|recording| {
            let compensation = lags[&recording.data_set].of_recording(&recording);
            Recording::new(py, recording.compensated(compensation))
        })
        .collect()
}

/// Recordings at or below a path; warns of doubts.
pub fn library(py: Python<'_>, path: &Path, strict: bool, as_recorded: bool) -> PyResult<Library> {
    let options = LoadOptions {
        strict,
        as_recorded,
        ..LoadOptions::default()
    };
    let library = py.detach(|| load(path, &options)).map_err(told)?;
    library.not_empty(path).map_err(told)?;
    for doubt in library.doubts() {
        let words = CString::new(doubt)?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &words, 1)?;
    }
    Ok(library)
}
