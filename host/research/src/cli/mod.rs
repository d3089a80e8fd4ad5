//! The command line: one file per subcommand.

mod cross_validate;
mod personalization;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use evaluation::report::Table;
use execution::progress;
use execution::run_folder::write_whole;
use myointent::cli::is_broken_pipe;

use crate::job::JobError;

/// Comparisons of presets and baselines, on the recordings and run folders of `myointent`.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 success, 1 failure, 2 wrong arguments, 130 interrupted."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Compare presets and baselines: every person but the test people held out once for each seed.
    CrossValidate(cross_validate::Arguments),
    /// Measure what tuning a model on a person's own recordings gains, by their duration.
    Personalization(personalization::Arguments),
}

impl Cli {
    /// Runs the command, prints its error if it fails, and returns the exit code.
    pub fn run(self) -> ExitCode {
        myointent::declare_revision();
        let result = match self.command {
            Command::CrossValidate(arguments) => cross_validate::run(&arguments),
            Command::Personalization(arguments) => personalization::run(&arguments),
        };
        match result {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
            Err(error) => {
                progress::log(&format!("error: {}", progress::with_causes(&*error)));
                if is_interrupt(&error) {
                    progress::log("to continue, give the same command");
                }
                exit_code(&error)
            }
        }
    }
}

/// Prints tables, an empty line after each.
fn print_tables(tables: &[Table], out: &mut impl Write) -> io::Result<()> {
    tables
        .iter()
        .try_for_each(|table| writeln!(out, "{}", table.plain()))
}

/// Writes tables and rows of people into a folder; returns the paths.
fn write_tables(folder: &Path, tables: &[Table], people: &Table) -> anyhow::Result<[PathBuf; 2]> {
    let [page, rows] = ["tables.md", "people.csv"].map(|name| folder.join(name));
    let tables: Vec<String> = tables.iter().map(Table::markdown).collect();
    write_whole(&page, tables.join("\n").as_bytes())?;
    write_whole(&rows, &people.csv()?)?;
    Ok([page, rows])
}

/// Exit code: 130 after Ctrl-C, 2 for wrong arguments, 1 after any other failure.
fn exit_code(error: &anyhow::Error) -> ExitCode {
    myointent::cli::exit_code(error, is_interrupt(error))
}

fn is_interrupt(error: &anyhow::Error) -> bool {
    let job = error.downcast_ref::<JobError>();
    job.is_some_and(JobError::is_interrupt) || myointent::cli::is_interrupt(error)
}

#[cfg(test)]
mod tests {
    use execution::run_folder::RunError;
    use training::run::StepError;
    use training::run::personalize::PersonalizeError;

    use super::*;

    #[test]
    fn an_interrupt_in_any_step_exits_with_130() {
        let interrupted = || RunError::Interrupted {
            path: "runs/x".into(),
        };
        let errors = [
            anyhow::Error::from(interrupted()),
            StepError::from(interrupted()).into(),
            JobError::from(interrupted()).into(),
            JobError::from(StepError::from(interrupted())).into(),
            JobError::from(PersonalizeError::Interrupted).into(),
        ];
        let code = |error: &anyhow::Error| format!("{:?}", exit_code(error));
        for error in &errors {
            assert_eq!(code(error), format!("{:?}", ExitCode::from(130)), "{error}");
        }
        let other = JobError::OtherRun {
            path: "runs/x".into(),
        };
        assert_eq!(code(&other.into()), format!("{:?}", ExitCode::FAILURE));
    }
}
