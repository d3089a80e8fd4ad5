//! Defines FLASH and RAM for the memory map of the workspace root, which the linker finds first.
//!
//! The regions are larger than a board's: 4 MiB for code, 16 MiB for variables, heap and stack. They
//! apply to every image that links this crate. `-Tlink.x` is an argument of the command that builds
//! the image (xtask/src/device.rs), since no build script can pass one to a library's unit tests.

use std::{env, error::Error, fs, path::PathBuf};

/// Two memories of the mps2-an386.
const REGIONS: &str = "\
MEMORY
{
  FLASH_TESTS : ORIGIN = 0x00000000, LENGTH = 4M
  RAM_TESTS   : ORIGIN = 0x21000000, LENGTH = 16M
}
REGION_ALIAS(FLASH, FLASH_TESTS)
REGION_ALIAS(RAM, RAM_TESTS)
";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("regions.x"), REGIONS)?;
    println!("cargo:rustc-link-search={}", out.display());
    Ok(())
}
