//! Builds the images of the boards and weighs them against the budgets of the design.

use std::{fmt, fs, path::PathBuf, process::Command};

use anyhow::{Context as _, Result, ensure};

use crate::clang;
use crate::size::{self, Size};
use crate::stack;
use crate::toolchain::{self, TARGET, Toolchain};
use crate::vectors;

/// Flash for code and constants, the SoftDevice's and the model's own excluded.
pub const FLASH_BUDGET: u64 = 160 * 1024;
/// Static RAM, the SoftDevice's own and the stack excluded.
pub const RAM_BUDGET: u64 = 48 * 1024;
/// Flash of the model, as `memory.x` has it.
pub const MODEL_REGION: u64 = 160 * 1024;
/// Least that must be left for the stack.
pub const STACK_BUDGET: u64 = 12 * 1024;

const PACKAGE: &str = "myointent-firmware";
const PROFILE: &str = "firmware";

/// A program for one board with one radio.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Image {
    /// nRF52840 under the SoftDevice S140.
    Nrf52840S140,
    /// The same, with the model copied to RAM.
    Nrf52840InRam,
    /// nRF52840 with the controller linked in.
    Nrf52840Sdc,
    /// nRF52832 under the SoftDevice S132.
    Nrf52832S132,
    /// QEMU's `mps2-an386`.
    Emulator,
}

impl Image {
    /// Every image.
    pub const ALL: [Self; 5] = [
        Self::Nrf52840S140,
        Self::Nrf52840InRam,
        Self::Nrf52840Sdc,
        Self::Nrf52832S132,
        Self::Emulator,
    ];

    /// Its name, and its file's.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nrf52840S140 => "nrf52840-s140",
            Self::Nrf52840InRam => "nrf52840-ram",
            Self::Nrf52840Sdc => "nrf52840-sdc",
            Self::Nrf52832S132 => "nrf52832-s132",
            Self::Emulator => "emulator",
        }
    }

    /// The firmware's features that make it.
    const fn features(self) -> &'static str {
        match self {
            Self::Nrf52840S140 => "nrf52840,radio-softdevice",
            Self::Nrf52840InRam => "nrf52840,radio-softdevice,model-in-ram",
            Self::Nrf52840Sdc => "nrf52840,radio-trouble",
            Self::Nrf52832S132 => "nrf52832,radio-softdevice",
            Self::Emulator => "emulator",
        }
    }

    /// Interrupts that must be served, by number: UART, time, GPIO and the radio's.
    const fn interrupts(self) -> &'static [usize] {
        match self {
            // UARTE0, GPIOTE, RTC1, SWI2.
            Self::Nrf52840S140 | Self::Nrf52840InRam | Self::Nrf52832S132 => &[2, 6, 17, 22],
            // CLOCK and POWER, RADIO, UARTE0, GPIOTE, TIMER0, RTC0, RTC1, SWI0.
            Self::Nrf52840Sdc => &[0, 1, 2, 6, 8, 11, 17, 20],
            // UART1 receiver, TIMER1.
            Self::Emulator => &[2, 9],
        }
    }

    /// Whether it is optimised at link time. Those under a SoftDevice cannot be (see
    /// firmware/build.rs); the others carry a Bluetooth host and need it.
    const fn links_as_a_whole(self) -> bool {
        matches!(self, Self::Nrf52840Sdc | Self::Emulator)
    }

    /// Static RAM that it may take: the budget, and what a copy of the model's region takes.
    const fn ram_budget(self) -> u64 {
        match self {
            Self::Nrf52840InRam => RAM_BUDGET + MODEL_REGION,
            _ => RAM_BUDGET,
        }
    }

    /// RAM that `memory.x` gives it.
    #[must_use]
    pub const fn ram(self) -> u64 {
        match self {
            Self::Nrf52840S140 | Self::Nrf52840InRam => (256 - 16) * 1024,
            Self::Nrf52840Sdc => 256 * 1024,
            Self::Nrf52832S132 => (64 - 16) * 1024,
            Self::Emulator => 64 * 1024,
        }
    }
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How to build.
#[derive(clap::Args)]
pub struct Arguments {
    /// Installs a missing cross compiler or libclang, as root, with apt-get.
    #[arg(long)]
    install: bool,
    /// Refuses to change Cargo.lock.
    #[arg(long)]
    locked: bool,
    /// Builds this one only.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Image::ALL.map(Image::name)))]
    image: Option<String>,
}

/// How to lint.
#[derive(clap::Args)]
pub struct LintArguments {
    /// Installs a missing compiler, linter or libclang, as root, with apt-get.
    #[arg(long)]
    install: bool,
    /// Refuses to change Cargo.lock.
    #[arg(long)]
    locked: bool,
}

/// Builds, prints a table of sizes, and fails where an image is over a budget.
///
/// # Errors
/// When there is no toolchain, an image does not build, or is too large.
pub fn build(arguments: &Arguments) -> Result<()> {
    let toolchain = toolchain::find(arguments.install)?;
    println!("{toolchain}");
    let mut rows = Vec::new();
    for image in Image::ALL {
        if arguments
            .image
            .as_deref()
            .is_none_or(|name| name == image.name())
        {
            let file = build_image(&toolchain, image, arguments.install, arguments.locked)?;
            println!("{}", file.display());
            rows.push((image, measure(&file)?));
        }
    }
    let emulator = kept(Image::Emulator);
    let stack = if emulator.is_file() {
        stack::measured(&emulator)?
    } else {
        None
    };
    println!("\n{}", Table { rows: &rows, stack });
    rows.iter()
        .try_for_each(|&(image, size)| within_budget(image, size))
}

/// Lints the program as each board and each radio compiles it.
///
/// # Errors
/// When there is no toolchain, or something to mend.
pub fn lint(arguments: &LintArguments) -> Result<()> {
    let toolchain = toolchain::find(arguments.install)?;
    // The nRF52832 differs by nothing but numbers.
    for image in [Image::Nrf52840S140, Image::Nrf52840Sdc, Image::Emulator] {
        println!("{image}");
        let mut cargo = cargo(
            &toolchain,
            "clippy",
            image,
            arguments.install,
            arguments.locked,
        )?;
        cargo.args(["--", "-D", "warnings"]);
        let status = cargo.status().context("clippy cannot be run")?;
        ensure!(status.success(), "the image {image} has lints to mend");
    }
    Ok(())
}

/// Builds an image; gives its ELF file.
///
/// # Errors
/// When it does not build.
pub fn build_image(
    toolchain: &Toolchain,
    image: Image,
    install: bool,
    locked: bool,
) -> Result<PathBuf> {
    let status = cargo(toolchain, "build", image, install, locked)?
        .status()
        .context("cargo cannot be run")?;
    ensure!(status.success(), "the image {image} did not build");

    // Every image is built to one name: keep each by its own.
    let built = target_directory().join(TARGET).join(PROFILE).join(PACKAGE);
    let kept = kept(image);
    let elf = fs::read(&built).with_context(|| format!("{} cannot be read", built.display()))?;
    vectors::check(&elf, image.interrupts()).with_context(|| format!("the image {image}"))?;
    fs::write(&kept, elf).with_context(|| format!("{} cannot be written", kept.display()))?;
    Ok(kept)
}

/// A cargo that does something to an image.
fn cargo(
    toolchain: &Toolchain,
    subcommand: &str,
    image: Image,
    install: bool,
    locked: bool,
) -> Result<Command> {
    let mut cargo = toolchain.cargo(subcommand);
    // --package keeps the host's crates, and their features, out of the build.
    cargo
        .args(["--profile", PROFILE, "--package", PACKAGE])
        .args(["--no-default-features", "--features", image.features()])
        .env("CARGO_TARGET_DIR", target_directory());
    if image == Image::Nrf52840Sdc
        && let Some(folder) = clang::find(install)?
    {
        cargo.env(clang::VARIABLE, folder);
    }
    if image.links_as_a_whole() {
        cargo.env("CARGO_PROFILE_FIRMWARE_LTO", "fat");
    }
    if locked {
        cargo.arg("--locked");
    }
    Ok(cargo)
}

/// Where an image is kept once it was built.
fn kept(image: Image) -> PathBuf {
    target_directory().join(image.name()).with_extension("elf")
}

/// The size of an image.
///
/// # Errors
/// When the file is no ELF image.
pub fn measure(file: &PathBuf) -> Result<Size> {
    let bytes = fs::read(file).with_context(|| format!("{} cannot be read", file.display()))?;
    size::measure(&bytes).with_context(|| format!("{} cannot be measured", file.display()))
}

/// A folder of its own, so that two cargo versions do not rebuild each other's work in turns.
pub fn target_directory() -> PathBuf {
    crate::target().join("cross")
}

struct Table<'r> {
    rows: &'r [(Image, Size)],
    /// Of the tasks, which are those of every image, in the emulator's runs.
    stack: Option<u64>,
}

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kib = |bytes: u64| bytes as f64 / 1024.0;
        let stack = self
            .stack
            .map_or_else(|| "-".to_owned(), |used| format!("{:.1}", kib(used)));
        writeln!(
            f,
            "| image, KiB    | code  | constants | flash | controller | own   | of  | static RAM | of  | left for the stack | stack measured |"
        )?;
        writeln!(
            f,
            "|---------------|-------|-----------|-------|------------|-------|-----|------------|-----|--------------------|----------------|"
        )?;
        for &(image, size) in self.rows {
            writeln!(
                f,
                "| {image:13} | {:5.1} | {:9.1} | {:5.1} | {:10.1} | {:5.1} | {:3} | {:10.1} | {:3} | {:18.1} | {stack:>14} |",
                kib(size.text),
                kib(size.rodata),
                kib(size.flash()),
                kib(size.controller),
                kib(size.own_flash()),
                FLASH_BUDGET / 1024,
                kib(size.ram()),
                image.ram_budget() / 1024,
                kib(image.ram().saturating_sub(size.ram())),
            )?;
        }
        Ok(())
    }
}

fn within_budget(image: Image, size: Size) -> Result<()> {
    ensure!(
        size.own_flash() <= FLASH_BUDGET,
        "{image}: {} bytes of flash, the controller's excluded; the budget is {FLASH_BUDGET}",
        size.own_flash()
    );
    ensure!(
        size.ram() <= image.ram_budget(),
        "{image}: {} bytes of static RAM, the budget is {}",
        size.ram(),
        image.ram_budget()
    );
    ensure!(
        size.ram() + STACK_BUDGET <= image.ram(),
        "{image}: {} of {} bytes of RAM taken, {STACK_BUDGET} must be left for the stack",
        size.ram(),
        image.ram()
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
            controller: 0,
        };
        let image = Image::Nrf52840S140;
        assert!(within_budget(image, full).is_ok());
        assert!(within_budget(image, Size { rodata: 1, ..full }).is_err());
        let more = Size {
            bss: full.bss + 1,
            ..full
        };
        assert!(within_budget(image, more).is_err());
    }

    #[test]
    fn the_small_chip_must_keep_room_for_its_stack() {
        let left = |stack| Size {
            bss: Image::Nrf52832S132.ram() - stack,
            ..Size::default()
        };
        assert!(within_budget(Image::Nrf52832S132, left(STACK_BUDGET)).is_ok());
        assert!(within_budget(Image::Nrf52832S132, left(STACK_BUDGET - 1)).is_err());
    }
}
