//! Exceptions: the words of the program's errors.

use std::error::Error as StdError;
use std::path::Path;

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use recordings::in_one_line;

create_exception!(
    myointent,
    Error,
    PyValueError,
    "A file, an array or a setting that cannot be used, in the words of the program `myointent`."
);

/// Exception of an error, with its causes.
pub fn told(error: impl StdError) -> PyErr {
    Error::new_err(in_one_line(&error))
}

/// Exception of an error about a file.
pub fn about<E: StdError>(path: &Path) -> impl FnOnce(E) -> PyErr {
    move |error| {
        let path = recordings::printable(&path.display().to_string());
        Error::new_err(format!("{path}: {}", in_one_line(&error)))
    }
}

/// Exception of an array of the wrong shape.
pub fn shape(expected: &str, found: &[usize]) -> PyErr {
    let found: Vec<String> = found.iter().map(ToString::to_string).collect();
    Error::new_err(format!("expected {expected}, found {}", found.join(" x ")))
}
