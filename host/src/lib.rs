//! The program: commands, the page of `live`, guided recording, and the line to a board.

#![deny(missing_docs)]

pub mod board;
pub mod cli;
pub mod live;
pub mod record;

/// Declares the Git revision that build.rs found, for the files that a command writes.
pub fn declare_revision() {
    execution::revision::declare(option_env!("MYOINTENT_REVISION"));
}
