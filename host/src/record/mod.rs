//! Guided recording sessions on a disk: journals, and the recordings made of them.

mod conversion;
mod error;
mod history;
pub(crate) mod journal;
mod person_quality;

pub(crate) use self::conversion::convert;
pub use self::conversion::{Conversion, recover};
pub use self::error::RecordError;
pub(crate) use self::history::HistoryOf;
pub(crate) use self::person_quality::{PersonQuality, quality_by_person};
