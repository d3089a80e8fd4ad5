//! Recordings of muscle activity and their labels: read, checked, divided by person, cut and
//! joined.
//!
//! A reader or a built-in description (`published.toml`) per published format; [`load`] recognises the format by content and name of the files.
//! Labels are mostly the cue that the person saw, not the muscle activity: [`labels::lag`] estimates
//! how much later the muscle acts. Where a set has no times, the muscle activity itself gives the
//! labels. Nothing here resamples, filters or scales a sample, but for `uci-gestures`, half of which is lost.

#![deny(missing_docs)]

pub mod alignment;
pub mod catalogue;
pub mod corpus;
pub mod description;
pub mod examiner;
#[cfg(test)]
mod fixture;
pub mod imu;
pub mod labels;
pub mod library;
pub mod raw_samples;
pub mod readers;
mod recording;
mod seed;
#[cfg(feature = "download")]
pub mod source;
pub mod split;
pub mod statistics;
pub mod synthetic;

pub use catalogue::DataSet;
pub use corpus::splice;
pub use examiner::finding::{Group, Severity, grouped};
pub use execution::printable::printable;
pub use labels::runs::{Run, runs};
pub use library::{Library, LoadOptions, load, load_all, load_bytes};
pub use readers::error::{LoadError, in_one_line};
pub use readers::npy;
pub use recording::by_data_set;
pub use recording::daily_life::{self, DailyKind};
pub use recording::movement;
pub use recording::movement::{Movement, MovementKind};
pub use recording::{Recording, Timing};
pub use split::folds;
