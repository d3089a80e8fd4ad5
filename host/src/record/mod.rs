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
pub mod journal;
mod keep;
mod layout;
pub mod protocol;
pub mod quality;
mod recorded;
pub mod session;
pub(crate) mod told;

pub use self::keep::{KeepError, Kept, keep, recover};
pub use self::recorded::{Recorded, recorded};
