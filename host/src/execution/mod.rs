//! Infrastructure of long computations: run folder, progress, interrupt, parallel work.

pub mod interrupt;
pub mod parallel;
pub mod progress;
pub mod run_folder;
