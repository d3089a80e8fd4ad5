//! The steps, as words of the command line.

use anyhow::Result;
use clap::{Parser, Subcommand};

use crate::{
    browser, count, emulator, energy, firmware, fuzz, merge, page, release, toolchain, uf2,
};

/// Build steps of the workspace that plain cargo cannot express.
#[derive(Parser)]
#[command(name = "cargo xtask")]
pub struct Arguments {
    #[command(subcommand)]
    step: Step,
}

#[derive(Subcommand)]
enum Step {
    /// Builds the images of all boards, prints their flash, RAM and stack, and fails over a budget.
    Images(firmware::Arguments),
    /// Flashes the board's program through a debug probe and shows its log.
    Board {
        /// More arguments of `cargo run`, such as features.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Writes one Intel hex of program, model and a SoftDevice: all that a chip is flashed with.
    Merge(merge::Arguments),
    /// Writes one UF2 file of program and model for a board with a boot loader that shows a drive.
    Uf2(uf2::Arguments),
    /// Writes the page as one file that a browser opens from the disk: it needs no program.
    Page(page::Arguments),
    /// Writes the files of a release: images, models, page, program, wheel, licences, checksums.
    Release(release::Arguments),
    /// Runs clippy on the board's program, for the targets and features of its images.
    Lint(firmware::Compiling),
    /// Counts the instructions of a patch on the emulated Cortex-M4F, part by part.
    Count(count::Arguments),
    /// Prints what a board takes from its battery, by the committed counts and the data sheet's currents.
    Energy,
    /// Fuzzes all that meets the outside, target by target, and fails on a finding.
    Fuzz(fuzz::Arguments),
    /// Prints which QEMU runs the tests of `shared`, and which Python the virtual armband.
    Emulator {
        /// Installs what is missing: QEMU with apt-get, as root; the armband's requirements with pip.
        #[arg(long)]
        install: bool,
    },
    /// Prints which browsers the tests of `myointent live` drive.
    Browser {
        /// Installs what is missing, as root, with apt-get.
        #[arg(long)]
        install: bool,
    },
    /// Prints which toolchain builds the board's images.
    Toolchain {
        /// Installs what is missing, as root, with apt-get.
        #[arg(long)]
        install: bool,
    },
}

impl Arguments {
    /// Runs the step.
    pub fn run(self) -> Result<()> {
        match self.step {
            Step::Images(arguments) => firmware::build(&arguments),
            Step::Board { arguments } => toolchain::run_on_board(&arguments),
            Step::Merge(arguments) => merge::run(&arguments),
            Step::Uf2(arguments) => uf2::run(&arguments),
            Step::Page(arguments) => page::run(&arguments),
            Step::Release(arguments) => release::run(&arguments),
            Step::Lint(compiling) => firmware::lint(compiling),
            Step::Count(arguments) => count::print(&arguments),
            Step::Energy => energy::print(),
            Step::Fuzz(arguments) => fuzz::run(&arguments),
            Step::Emulator { install } => emulator::prepare(install),
            Step::Browser { install } => browser::prepare(install),
            Step::Toolchain { install } => {
                toolchain::find(toolchain::TARGET, install).map(|found| println!("{found}"))
            }
        }
    }
}
