//! The project's own build steps: which compiler builds for the board, and what comes out of it.
//!
//! A library as well as a command, because the tests that start an emulator build what it runs.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod clang;
pub mod count;
mod debian;
pub mod device;
pub mod emulator;
pub mod firmware;
#[cfg(test)]
mod pages;
pub mod qemu;
pub mod size;
pub mod stack;
pub mod toolchain;
pub mod vectors;

use std::{
    env,
    path::{Path, PathBuf},
};

/// The folder of the workspace.
fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// Where build products go.
fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from)
}
