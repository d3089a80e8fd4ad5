//! What every long computation shares: its folder, its progress, Ctrl-C, and the cores.

pub mod interrupt;
pub mod parallel;
pub mod progress;
pub mod run_folder;
