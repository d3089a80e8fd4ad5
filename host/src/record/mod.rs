//! Guided recording sessions: protocol, session, journal, and the recordings made of it.
//!
//! ```text
//! protocol -> session -> journal -> assembly -> csv, findings -> personalize
//! a file      sans-IO    append-    labels of   whether it is    a model of
//!                        only       the muscle  good enough      one's own
//! ```
//!
//! `live` drives a session: samples of its source go in, cues for its page come out.

mod assembly;
mod conversion;
mod error;
mod history;
pub(crate) mod journal;
mod person_quality;
pub mod protocol;
pub(crate) mod quality;
pub(crate) mod session;

pub(crate) use self::conversion::convert;
pub use self::conversion::{Conversion, recover};
pub use self::error::RecordError;
pub(crate) use self::history::HistoryOf;
pub(crate) use self::person_quality::{PersonQuality, quality_by_person};
