//! Recordings of muscle activity and their labels: read, checked, divided by person, cut and
//! joined.
//!
//! One reader per published format; [`load`] recognises the format by the content of the files.
//! Labels are the cue that the person saw, not the muscle activity: [`labels::lag`] estimates how
//! much later the muscle acts. Nothing here resamples, filters or scales a sample.

pub mod corpus;
mod electrodes;
pub mod labels;
pub mod lead_in;
pub(crate) mod library;
pub(crate) mod readers;
mod recording;
mod seed;
pub mod splice;
pub mod split;
pub mod synthetic;

pub use labels::runs::{Run, runs};
pub use library::{Library, LoadOptions, Repeat, load};
pub use readers::error::{Fault, LoadError, Place};
pub use readers::npy;
pub use recording::{DataSet, Recording};
pub use split::folds;
