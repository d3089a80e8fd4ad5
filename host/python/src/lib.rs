//! Python package `myointent`: model files, the device's pipeline, the metrics and the readers of recordings, with numpy
//! arrays in and out.
//!
//! Nothing is computed here: each function calls the crate that does it for the program. docs/python.md shows the use.

#![deny(missing_docs)]
#![deny(unsafe_code)]

mod around;
mod arrays;
mod calibration;
mod evaluation;
mod event;
mod failure;
mod model;
mod recording;
mod report;
mod score;
mod stream;

/// Models, streams, scores and recordings of an armband with 8 channels at 200 Hz.
#[pyo3::pymodule(name = "_myointent")]
mod module {
    use pyo3::prelude::*;
    use pyo3::types::PyTuple;
    use shared::intent::Intent;

    #[pymodule_export]
    use crate::around::{Patches, Smoother};
    #[pymodule_export]
    use crate::calibration::{Calibration, calibrate};
    #[pymodule_export]
    use crate::evaluation::evaluate;
    #[pymodule_export]
    use crate::event::Event;
    #[pymodule_export]
    use crate::failure::Error;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::recording::{Recording, read};
    #[pymodule_export]
    use crate::report::Report;
    #[pymodule_export]
    use crate::score::score;
    #[pymodule_export]
    use crate::stream::Stream;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let names = PyTuple::new(module.py(), Intent::ALL.map(Intent::name))?;
        module.add("INTENTS", names)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
