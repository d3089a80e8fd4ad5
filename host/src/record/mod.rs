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
mod error;
pub(crate) mod journal;
mod keep;
pub mod protocol;
pub(crate) mod quality;
mod recorded;
pub(crate) mod session;

pub use self::error::RecordError;
pub(crate) use self::keep::keep;
pub use self::keep::{Kept, recover};
pub(crate) use self::recorded::{Recorded, recorded};
