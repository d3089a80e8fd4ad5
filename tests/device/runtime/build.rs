//! Puts the linker script for the emulated board where the linker finds it.
//!
//! The search path reaches every image that links this crate; `-Temulator.x` itself is an argument
//! of the command that builds the image, for no build script can give one to a library's tests.

use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=emulator.x");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy("emulator.x", out.join("emulator.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    Ok(())
}
