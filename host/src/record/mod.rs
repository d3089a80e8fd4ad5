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
pub mod journal;
mod keep;
pub mod protocol;
pub mod quality;
mod recorded;
pub mod session;

pub use self::error::RecordError;
pub use self::keep::{Kept, keep, recover};
pub use self::recorded::{Recorded, recorded};
