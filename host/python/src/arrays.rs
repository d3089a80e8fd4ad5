//! Samples and labels from and to numpy arrays.

use std::fmt::Display;

use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use numpy::{PyUntypedArrayMethods as _, get_array_module};
use pyo3::prelude::*;
use recordings::labels::motion::Motion;
use recordings::raw_samples::raw_samples;
use recordings::readers::label_file::{from_number, from_text};
use shared::intent::Intent;
use shared::units::{CHANNELS, Sample};

use crate::failure::{Error, shape, told};

/// Array of whole numbers in order, made of anything that numpy takes.
fn numbers<'py>(values: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = get_array_module(values.py())?;
    let array = numpy.call_method1("ascontiguousarray", (values, "float64"))?;
    array.extract()
}

/// Passes samples to `take`: without a copy from an int8 array whose rows follow each other in memory.
pub fn with_samples<R>(
    emg: &Bound<'_, PyAny>,
    take: impl FnOnce(&[Sample]) -> PyResult<R>,
) -> PyResult<R> {
    if let Ok(array) = emg.extract::<PyReadonlyArray2<'_, i8>>()
        && array.shape()[1] == CHANNELS
        // A slice has the order of the memory, which may be column by column.
        && array.is_c_contiguous()
        && let Ok(values) = array.as_slice()
    {
        return take(values.as_chunks().0);
    }
    let array = numbers(emg)?;
    if array.ndim() != 2 || array.shape()[1] != CHANNELS {
        return Err(shape("an array of n x 8 raw samples", array.shape()));
    }
    take(&raw_samples(array.as_slice()?).map_err(told)?)
}

/// Motion of each sample from class numbers or names.
pub fn motions(labels: &Bound<'_, PyAny>) -> PyResult<Vec<Motion>> {
    if let Ok(array) = labels.extract::<PyReadonlyArray1<'_, i8>>() {
        return each(array.as_array().iter(), |&number| {
            from_number(number.into())
        });
    }
    if let Ok(names) = labels.extract::<Vec<String>>() {
        return each(&names, |name| from_text(name));
    }
    let array = numbers(labels)?;
    if array.ndim() != 1 {
        return Err(shape("an array of one label a sample", array.shape()));
    }
    each(array.as_slice()?, |&number| from_number(number))
}

/// Motion of each label, by its number or name.
fn each<T, E: Display>(
    labels: impl IntoIterator<Item = T>,
    motion: impl Fn(T) -> Result<Motion, E>,
) -> PyResult<Vec<Motion>> {
    let labels = labels.into_iter().enumerate();
    let motion = |(row, label)| {
        motion(label).map_err(|fault| Error::new_err(format!("label {row}: {fault}")))
    };
    labels.map(motion).collect()
}

/// Class numbers of labels, -1 for a sample without a label.
pub fn classes<'py>(py: Python<'py>, labels: &[Option<Intent>]) -> Bound<'py, PyArray1<i8>> {
    let number = |label: &Option<Intent>| label.map_or(Motion::Unknown, Motion::Intent).number();
    PyArray1::from_vec(py, labels.iter().map(number).collect())
}
