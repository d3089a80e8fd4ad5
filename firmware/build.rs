//! Passes the linker the memory map of the workspace root, which of its regions are FLASH and RAM, and
//! the scripts of the runtime; refuses targets that the program is too slow on; fixes the revision of the source.
//!
//! Not in `.cargo/config.toml`: flags there apply to every crate built for the target, and `RUSTFLAGS`
//! in the environment replaces them silently. One map for all images, because the linker looks for
//! `memory.x` first in the folder that cargo was started in.

use std::{env, error::Error, fs, path::PathBuf, process::Command};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=../memory.x");
    println!("cargo:rustc-env=MYOINTENT_REVISION={}", revision());
    let is_simulated = env::var("CARGO_CFG_TARGET_OS")? != "none";
    let image = if is_simulated { "simulated" } else { image() };
    println!("cargo:rustc-env=MYOINTENT_IMAGE={image}");
    if is_simulated {
        return Ok(());
    }
    let target = env::var("TARGET")?;
    if !has_fpu_and_dsp(&target) {
        let error = format!(
            "{target} has no FPU or no DSP instructions for this program, and a patch would take longer than it \
             lasts: build for thumbv7em-none-eabihf"
        );
        return Err(error.into());
    }
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let (flash, ram) = regions();
    let mut script = format!("REGION_ALIAS(FLASH, {flash})\nREGION_ALIAS(RAM, {ram})\n");
    if has("radio-softdevice") {
        // The register crates of embassy-nrf and nrf-softdevice each define a vector table, and
        // name some interrupts differently. The linker uses the first table; the other stays in the
        // image unused. Whichever it uses, both names must lead to the same handler. `cargo xtask
        // images` checks the table of the linked image.
        println!("cargo:rustc-link-arg-bins=--allow-multiple-definition");
        script += "EXTERN(UARTE0)\nUARTE0_UART0 = UARTE0;\n";
        script += "EXTERN(SWI2_EGU2)\nEGU2_SWI2 = SWI2_EGU2;\n";
        for name in NAMED_TWICE.split_whitespace() {
            script += &format!("PROVIDE({name} = DefaultHandler);\n");
        }
    }
    fs::write(out.join("regions.x"), script)?;
    fs::copy("../memory.x", out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    // Without --nmagic the linker aligns segments to pages of 64 KiB and so moves the start of flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    Ok(())
}

/// Whether the kernels for the Cortex-M4F run; `shared` decides by the same name.
pub(crate) fn has_fpu_and_dsp(target: &str) -> bool {
    target.starts_with("thumbv7em-") && target.ends_with("eabihf")
}

/// The commit, with `-dirty` if tracked files differ from it; `unknown` outside a repository.
fn revision() -> String {
    for watched in ["src", "../shared/src"] {
        println!("cargo:rerun-if-changed={watched}");
    }
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) =
            git(&["rev-parse", "--git-path", name]).filter(|path| fs::exists(path).unwrap_or(false))
        {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let describe = [
        "--no-optional-locks",
        "describe",
        "--always",
        "--abbrev=12",
        "--dirty",
        "--exclude=*",
    ];
    git(&describe).unwrap_or_else(|| "unknown".to_owned())
}

/// Output of git in this package's folder; none if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let folder = env::var_os("CARGO_MANIFEST_DIR")?;
    let output = Command::new("git")
        .args(arguments)
        .current_dir(folder)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}

/// Interrupts that the two register crates name differently, under both names.
const NAMED_TWICE: &str = "
    AAR_CCM CLOCK_POWER EGU0_SWI0 EGU1_SWI1 EGU3_SWI3 EGU4_SWI4 EGU5_SWI5 SPI2 TWISPI0 TWISPI1
    CCM_AAR POWER_CLOCK SWI0_EGU0 SWI1_EGU1 SWI3_EGU3 SWI4_EGU4 SWI5_EGU5 SPIM2_SPIS2_SPI2
    SPIM0_SPIS0_TWIM0_TWIS0_SPI0_TWI0 SPIM1_SPIS1_TWIM1_TWIS1_SPI1_TWI1
";

/// FLASH and RAM among the regions of `memory.x`.
fn regions() -> (&'static str, &'static str) {
    if has("uf2") {
        return ("FLASH_UF2", "RAM_UF2");
    }
    match (has("nrf52832"), has("radio-trouble")) {
        (true, true) => ("FLASH_BARE", "RAM_NRF52832"),
        (true, false) => ("FLASH_NRF52832_S132", "RAM_NRF52832_S132"),
        (false, true) => ("FLASH_BARE", "RAM_NRF52840"),
        (false, false) => ("FLASH_NRF52840_S140", "RAM_NRF52840_S140"),
    }
}

/// The image, by the name that `cargo xtask images` gives it.
fn image() -> &'static str {
    let board = ["xiao", "feather", "nice-nano"]
        .into_iter()
        .find(|board| has(board));
    board.unwrap_or(match (has("nrf52832"), has("radio-trouble")) {
        (true, true) => "nrf52832-sdc",
        (true, false) => "nrf52832-s132",
        (false, true) => "nrf52840-sdc",
        (false, false) => "nrf52840-s140",
    })
}

fn has(feature: &str) -> bool {
    let variable = feature.to_uppercase().replace('-', "_");
    env::var_os(format!("CARGO_FEATURE_{variable}")).is_some()
}
