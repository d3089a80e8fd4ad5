//! What the readers import of the host's module of this name.
#![allow(dead_code, missing_docs, reason = "the source of another crate")]

#[path = "../../../host/src/execution/bounded_read.rs"]
pub mod bounded_read;
#[path = "../../../host/src/execution/file_kind.rs"]
pub mod file_kind;
