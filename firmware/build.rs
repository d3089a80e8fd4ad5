//! Hands the linker the memory map of the workspace root, the choice among its regions, and the
//! scripts of the runtime.
//!
//! Here and not in `.cargo/config.toml`: flags there would reach every crate built for the target,
//! and a `RUSTFLAGS` in the environment would silently replace them. And one map for all images,
//! because the linker looks for `memory.x` where cargo was started before it looks anywhere else.

use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let (flash, ram) = regions();
    fs::write(
        out.join("regions.x"),
        format!("REGION_ALIAS(FLASH, {flash})\nREGION_ALIAS(RAM, {ram})\n"),
    )?;
    fs::copy("../memory.x", out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    // Without --nmagic the linker pads segments to 64 KiB pages, past the start of flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if has("chip") {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    } else {
        // Names of a chip's interrupts; the emulator's board brings its own table.
        fs::write(out.join("device.x"), "")?;
    }
    Ok(())
}

/// FLASH and RAM among the regions of `memory.x`.
fn regions() -> (&'static str, &'static str) {
    match (has("emulator"), has("nrf52832"), has("radio-trouble")) {
        (true, ..) => ("FLASH_BARE", "RAM_EMULATOR"),
        (_, true, true) => ("FLASH_BARE", "RAM_NRF52832"),
        (_, true, false) => ("FLASH_NRF52832_S132", "RAM_NRF52832_S132"),
        (_, false, true) => ("FLASH_BARE", "RAM_NRF52840"),
        (_, false, false) => ("FLASH_NRF52840_S140", "RAM_NRF52840_S140"),
    }
}

fn has(feature: &str) -> bool {
    let variable = feature.to_uppercase().replace('-', "_");
    env::var_os(format!("CARGO_FEATURE_{variable}")).is_some()
}
