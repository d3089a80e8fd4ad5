//! The project's own build steps, run as `cargo xtask STEP`.
//!
//! Steps that plain cargo cannot express: they choose a toolchain and look at what came out.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

use anyhow::Result;
use clap::{Parser, Subcommand};
use xtask::{count, emulator, firmware, toolchain};

/// Build steps of the workspace that plain cargo cannot express.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    step: Step,
}

#[derive(Subcommand)]
enum Step {
    /// Builds the images of all boards and prints what they take of flash and RAM.
    Images(firmware::Arguments),
    /// Lints the board's program, which no linter of this machine's own target sees.
    Lint(firmware::LintArguments),
    /// Counts the instructions that a patch takes on the emulated Cortex-M4F, part by part.
    Count(count::Arguments),
    /// Says which emulator and which Python would run the end-to-end tests, and adds them if asked.
    Emulator {
        /// Installs what is missing: QEMU with apt-get, as root; the armband's requirements with pip.
        #[arg(long)]
        install: bool,
    },
    /// Says which toolchain would build the board's image, and installs it if asked.
    Toolchain {
        /// Installs what is missing, as root, with apt-get.
        #[arg(long)]
        install: bool,
    },
}

fn main() -> Result<()> {
    match Arguments::parse().step {
        Step::Images(arguments) => firmware::build(&arguments),
        Step::Lint(arguments) => firmware::lint(&arguments),
        Step::Count(arguments) => count::print(&arguments),
        Step::Emulator { install } => emulator::prepare(install),
        Step::Toolchain { install } => toolchain::find(install).map(|found| println!("{found}")),
    }
}
