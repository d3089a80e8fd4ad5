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
pub mod release;
pub mod size;
pub mod stack_chain;
pub mod steps;
pub mod toolchain;
pub mod uf2;

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSymbol as _};

fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from)
}

/// Returns the folder of the board's build products: one of its own, so that two versions of cargo do not rebuild each
/// other's products.
fn cross_target() -> PathBuf {
    target().join("cross")
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("{} cannot be read", path.display()))
}

fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    fs::write(path, content).with_context(|| format!("{} cannot be written", path.display()))
}

/// Address of a symbol of an image.
fn address(elf: &[u8], name: &str) -> Result<u32> {
    let image = object::File::parse(elf).context("the image is no ELF file")?;
    let symbol = image.symbols().find(|symbol| symbol.name() == Ok(name));
    let symbol = symbol.with_context(|| format!("the image has no symbol {name}"))?;
    u32::try_from(symbol.address()).context("an address of more than 32 bits")
}

/// Runs a command to its end; fails with `otherwise` if it does.
fn run(command: &mut Command, otherwise: &str) -> Result<()> {
    let status = command.status();
    let program = Path::new(command.get_program()).display();
    let status = status.with_context(|| format!("{program} cannot be run"))?;
    ensure!(status.success(), "{otherwise}");
    Ok(())
}

/// The cargo that runs this program, in the workspace.
fn cargo() -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(workspace());
    cargo
}

/// Output of the compiler that compiles this program.
fn rustc(arguments: &[&str]) -> Result<String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).args(arguments).output();
    let output = output.context("rustc cannot be run")?;
    Ok(String::from_utf8(output.stdout)?)
}

/// Target triple of this system, as rustc names it.
fn host() -> Result<String> {
    let text = rustc(&["-vV"])?;
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc names no host")?.to_owned())
}
