//! Guided recording sessions without I/O: protocol, session, journal, and the recordings made of it.
//!
//! ```text
//! protocol -> session -> journal -> assembly -> csv, findings -> personalize
//! a file      sans-IO    append-    labels of   whether it is    a model of
//!                        only       the muscle  good enough      one's own
//! ```

pub mod assembly;
pub mod csv;
pub mod journal;
pub mod protocol;
pub mod quality;
pub mod remark;
pub mod session;
