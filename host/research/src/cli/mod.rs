//! The command line: parse and dispatch; one file a subcommand.

mod baselines;
mod evaluate;
mod study;
mod summary;
mod tables;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use myointent::cli::{exit_code, is_broken_pipe};

/// The paper's baselines and comparisons, on the recordings and run folders of `myointent`.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 done, 1 failed, 2 wrong arguments, 130 interrupted (continue with --resume)."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Train the paper's baselines on the recordings and the split of a run.
    Baselines(baselines::Arguments),
    /// Evaluate a run's models and its baselines on the held-out people.
    Evaluate(evaluate::Arguments),
    /// Train and evaluate every comparison of the paper, everybody held out in turn.
    Study(study::Arguments),
    /// Merge the results of a protocol's folds.
    Summary(summary::Arguments),
    /// Write a study's tables, in the paper's layout, as Markdown and CSV.
    Tables(tables::Arguments),
}

impl Cli {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let result = match self.command {
            Command::Baselines(arguments) => baselines::run(&arguments),
            Command::Evaluate(arguments) => evaluate::run(&arguments),
            Command::Study(arguments) => study::run(&arguments),
            Command::Summary(arguments) => summary::run(&arguments),
            Command::Tables(arguments) => tables::run(&arguments),
        };
        match result {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error:#}");
                exit_code(&error)
            }
        }
    }
}
