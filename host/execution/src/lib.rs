//! Infrastructure of long computations: run folder, progress, interrupt, parallel work, bounded reads.

#![deny(missing_docs)]

pub mod bounded_read;
pub mod file_kind;
pub mod fingerprint;
pub mod interrupt;
pub mod parallel;
pub mod progress;
pub mod revision;
pub mod run_folder;
