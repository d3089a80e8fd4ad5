//! The host's readers of recordings, from their sources: the crate itself would bring a library for training networks,
//! which takes minutes to compile. What they import of their crate has the same place here.
#![allow(
    dead_code,
    unused_imports,
    missing_docs,
    reason = "the sources of another crate, of which only the readers are called"
)]

#[path = "../../../host/src/dataset/examiner/mod.rs"]
pub(crate) mod examiner;
#[path = "../../../host/src/dataset/finding/mod.rs"]
pub(crate) mod finding;
#[path = "dataset_labels.rs"]
pub(crate) mod labels;
#[path = "../../../host/src/dataset/readers/mat/fixture.rs"]
pub(crate) mod mat_fixture;
#[path = "../../../host/src/dataset/movement.rs"]
pub mod movement;
#[path = "../../../host/src/dataset/readers/mod.rs"]
pub(crate) mod readers;
#[path = "../../../host/src/dataset/recording.rs"]
mod recording;

pub use readers::error::{Fault, LoadError, Place};
pub use readers::npy;
pub use recording::{DataSet, Recording};
