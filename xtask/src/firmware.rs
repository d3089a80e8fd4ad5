//! Builds the board's image and weighs it against the budgets of the design.

use std::{env, fs, path::PathBuf};

use anyhow::{Context as _, Result, ensure};

use crate::{
    size::{self, Size},
    toolchain::{self, TARGET},
};

/// Flash for code and constants, the SoftDevice's and the model's own excluded.
const FLASH_BUDGET: u64 = 160 * 1024;
/// Static RAM, the SoftDevice's own and the stack excluded.
const RAM_BUDGET: u64 = 48 * 1024;

const PACKAGE: &str = "myointent-firmware";

/// How to build.
#[derive(clap::Args)]
pub struct Arguments {
    /// Installs a missing cross compiler, as root, with apt-get.
    #[arg(long)]
    install: bool,
    /// Refuses to change Cargo.lock.
    #[arg(long)]
    locked: bool,
}

/// Builds, prints the sizes, and fails where the image is over its budget.
pub fn build(arguments: &Arguments) -> Result<()> {
    let toolchain = toolchain::find(arguments.install)?;
    println!("{toolchain}");

    let directory = target_directory();
    let mut cargo = toolchain.cargo("build");
    // --package keeps the host's crates, and their features, out of the build.
    cargo
        .args(["--release", "--package", PACKAGE])
        .env("CARGO_TARGET_DIR", &directory);
    if arguments.locked {
        cargo.arg("--locked");
    }
    let status = cargo.status().context("cargo cannot be run")?;
    ensure!(status.success(), "the image did not build");

    let image = directory.join(TARGET).join("release").join(PACKAGE);
    let bytes = fs::read(&image).with_context(|| format!("{} cannot be read", image.display()))?;
    let size =
        size::measure(&bytes).with_context(|| format!("{} cannot be measured", image.display()))?;
    println!("{}\n{size}", image.display());
    within_budget(size)
}

/// A folder of its own, so that two cargo versions do not rebuild each other's work in turns.
fn target_directory() -> PathBuf {
    let workspace = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let shared =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    shared.join("cross")
}

fn within_budget(size: Size) -> Result<()> {
    ensure!(
        size.flash() <= FLASH_BUDGET,
        "flash: {} bytes, the budget is {FLASH_BUDGET}",
        size.flash()
    );
    ensure!(
        size.ram() <= RAM_BUDGET,
        "RAM: {} bytes, the budget is {RAM_BUDGET}",
        size.ram()
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_counts_initial_values_twice_and_admits_its_last_byte() {
        let full = Size {
            text: FLASH_BUDGET - 10,
            rodata: 0,
            data: 10,
            bss: RAM_BUDGET - 10,
        };
        assert!(within_budget(full).is_ok());
        assert!(within_budget(Size { rodata: 1, ..full }).is_err());
        assert!(
            within_budget(Size {
                bss: full.bss + 1,
                ..full
            })
            .is_err()
        );
    }
}
