//! Builds and lints the images of the boards, and checks their sizes.

mod budget;
mod cargo;
mod contents;
mod image;

use anyhow::{Context as _, Result};

pub use cargo::{build_image, build_simulation, short_paths};
pub use image::Image;

use crate::toolchain::TARGET;
use crate::{read, run, size, stack_chain, toolchain};
use budget::{BudgetRow, BudgetTable};

/// Options of each command that compiles images.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct Compiling {
    /// Installs a missing cross compiler or libclang, as root, with apt-get.
    #[arg(long)]
    pub install: bool,
    /// Refuses to change Cargo.lock.
    #[arg(long)]
    pub locked: bool,
}

/// Options of the build.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    compiling: Compiling,
    /// Builds this one only.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Image::ALL.map(Image::name)))]
    image: Option<String>,
}

/// Builds, prints a table of sizes, and fails where an image is over a budget.
pub fn build(arguments: &Arguments) -> Result<()> {
    let toolchain = toolchain::find(TARGET, arguments.compiling.install)?;
    println!("{toolchain}");
    let selected = arguments.image.as_deref();
    let mut rows = Vec::new();
    for image in Image::ALL {
        if selected.is_none_or(|name| name == image.name()) {
            let file = build_image(&toolchain, image, arguments.compiling)?;
            println!("{}", file.display());
            let bytes = read(&file)?;
            let size = size::measure(&bytes)
                .with_context(|| format!("{} cannot be measured", file.display()))?;
            let chain = stack_chain::deepest(&bytes)?;
            println!("{chain}");
            rows.push(BudgetRow {
                image,
                size,
                chain: chain.bytes,
            });
        }
    }
    println!("\n{}", BudgetTable(&rows));
    rows.iter().try_for_each(budget::check)
}

/// Lints the program as each board and each radio compiles it.
pub fn lint(compiling: Compiling) -> Result<()> {
    let toolchain = toolchain::find(TARGET, compiling.install)?;
    // The nRF52832, and boards with the same features, differ by numbers alone. The image of a kit is also looked at as it is for
    // a board without a crystal.
    let images = [
        (Image::Nrf52840S140, "oscillator"),
        (Image::Nrf52840S140, "crystal"),
        (Image::Nrf52840Sdc, "oscillator"),
        (Image::Xiao, "oscillator"),
    ];
    for (image, slow_clock) in images {
        println!("{image}, {slow_clock}");
        let mut clippy = cargo::command(&toolchain, "clippy", image, compiling)?;
        clippy
            .env("MYOINTENT_SLOW_CLOCK", slow_clock)
            .args(["--", "-D", "warnings"]);
        run(&mut clippy, &format!("the image {image} has lints to fix"))?;
    }
    Ok(())
}
