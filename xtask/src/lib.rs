//! Build steps that plain cargo cannot express: cross builds, sizes, instruction counts, fuzzing, checks of the sources.
//!
//! A library as well as a command: the tests that emulate a chip build its images with it.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod browser;
pub mod clang;
pub mod count;
mod debian;
pub mod device;
pub mod emulator;
pub mod energy;
pub mod firmware;
pub mod fuzz;
pub mod merge;
pub mod page;
#[cfg(test)]
mod pages;
pub mod qemu;
pub mod release;
pub mod size;
pub mod stack_chain;
pub mod symbols;
pub mod toolchain;
pub mod uf2;
pub mod vectors;

use std::{
    env,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result};

/// The folder of the workspace.
fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// Returns the folder of the build products.
fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from)
}

/// Returns the folder of the board's build products: one of its own, so that two versions of cargo do not rebuild each
/// other's products.
fn cross_target() -> PathBuf {
    target().join("cross")
}

/// Target triple of this system, as rustc names it.
fn host() -> Result<String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("-vV").output()?;
    let text = String::from_utf8(output.stdout)?;
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc names no host")?.to_owned())
}
