//! Cargo, called so that it builds or lints one image.

use std::{env, fs, path::PathBuf, process::Command};

use anyhow::{Context as _, Result};

use super::image::Image;
use super::{Compiling, contents};
use crate::toolchain::{TARGET, Toolchain};
use crate::{clang, cross_target, read, run, target, write};

const PACKAGE: &str = "myointent-firmware";
const PROFILE: &str = "firmware";

/// Builds an image; returns its ELF file.
pub fn build_image(toolchain: &Toolchain, image: Image, compiling: Compiling) -> Result<PathBuf> {
    let mut cargo = command(toolchain, "rustc", image, compiling)?;
    if image.has_controller() {
        // An image with a Bluetooth host needs it to fit; one under a SoftDevice cannot have it (firmware/build.rs). An option
        // of the program alone, not of the profile: all images have the same libraries.
        cargo.args(["--", "-C", "lto=fat"]);
    }
    run(&mut cargo, &format!("the image {image} did not build"))?;

    // Cargo gives every image the same name: keep a copy of each under its own.
    let built = cross_target().join(TARGET).join(PROFILE).join(PACKAGE);
    let kept = elf_file(image);
    let elf = read(&built)?;
    contents::check(&elf, image.interrupts()).with_context(|| format!("the image {image}"))?;
    write(&kept, elf)?;
    Ok(kept)
}

/// Builds the program for this computer, where the board is simulated; returns the program's file.
pub fn build_simulation() -> Result<PathBuf> {
    let mut cargo = crate::cargo();
    cargo
        .args(["build", "--locked", "--quiet", "--package", PACKAGE])
        .env("CARGO_TARGET_DIR", target());
    run(&mut cargo, "the simulated board did not build")?;
    let program = format!("{PACKAGE}{}", std::env::consts::EXE_SUFFIX);
    Ok(target().join("debug").join(program))
}

/// A cargo command for an image.
pub fn command(
    toolchain: &Toolchain,
    subcommand: &str,
    image: Image,
    compiling: Compiling,
) -> Result<Command> {
    let mut cargo = toolchain.cargo(subcommand, TARGET);
    // --package keeps the host's crates, and their features, out of the build.
    cargo
        .args(["--profile", PROFILE, "--package", PACKAGE])
        .args(["--no-default-features", "--features", image.features()])
        .env("CARGO_TARGET_DIR", cross_target())
        .env("RUSTFLAGS", short_paths() + " -C embed-bitcode=yes");
    if image.has_controller()
        && let Some(folder) = clang::find(compiling.install)?
    {
        cargo.env(clang::VARIABLE, folder);
    }
    if compiling.locked {
        cargo.arg("--locked");
    }
    Ok(cargo)
}

/// The caller's flags, and with them no path of this computer in what a panic says: on a board 3 KiB of flash, and the same
/// bytes wherever an image is built.
pub fn short_paths() -> String {
    let mut flags = env::var("RUSTFLAGS").unwrap_or_default();
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo")));
    let sources = home.and_then(|home| fs::read_dir(home.join("registry/src")).ok());
    let registries = sources
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    for folder in registries.chain([PathBuf::from("/usr/lib/rustlib/src/rust/library")]) {
        // Flags are divided at spaces.
        if let Some(folder) = folder.to_str().filter(|folder| !folder.contains(' ')) {
            flags += &format!(" --remap-path-prefix={folder}/=");
        }
    }
    flags
}

/// The file of an image, whether it was built already or not.
pub fn elf_file(image: Image) -> PathBuf {
    cross_target().join(image.name()).with_extension("elf")
}
