//! The command line: parse, call, print. One file a subcommand; those of a run folder are in `steps`.

pub mod arguments;
mod board;
mod built_in;
mod calibrate;
mod contents;
mod data;
mod evaluate;
mod evaluate_models;
#[cfg(feature = "fetch")]
mod fetch;
mod flash;
mod gate;
mod info;
mod live;
mod output;
mod predict;
mod record;
pub mod replay;
mod report;
mod score;
#[cfg(feature = "train")]
pub mod steps;
mod template;

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::error::{ContextKind, ContextValue};
use clap::{Parser, Subcommand};

use execution::run_folder::RunError;
use execution::{bounded_read, interrupt, progress};
use presets::PresetError;
use presets::resolve::ConfigError;

/// Intent detection from Myo recordings: train, distil, quantize, evaluate, replay, look.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    long_about = "Trains intent detection on recordings of a Myo armband (8 channels, 200 Hz), writes it as a model file for\n\
                  a microcontroller, and evaluates it on subjects that are held out from training.",
    after_help = concat!("Start here:\n  \
                  myointent quickstart                                       all steps in one command, in a few minutes\n  \
                  myointent replay models/three-class.intent RECORDING       the UART lines that the device would write\n  \
                  myointent live --demo                                      EMG and labels on a page, without hardware\n  \
                  myointent record --person me --demo                        one's own recordings, guided, on a page\n\n\
                  Step by step, each into the same run folder:\n  \
                  myointent train --preset cpu --data DIR --run runs/mine\n  \
                  myointent quantize --run runs/mine\n  \
                  myointent evaluate --run runs/mine\n\n\
                  The program contains models/three-class.intent, models/five-class.intent and models/six-class.intent.\n\
                  Pages, such as docs/presets.md on every setting of a preset: ", env!("CARGO_PKG_REPOSITORY"), "\n\n\
                  Exit codes: 0 done, 1 failed, 2 wrong arguments, 3 `calibrate` or `personalize` keeps the old model, 130 interrupted.")
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Commands that train.
    #[cfg(feature = "train")]
    #[command(flatten)]
    Steps(steps::Command),
    /// Inspect recordings, or write synthetic ones.
    #[command(subcommand)]
    Data(data::DataCommand),
    /// Evaluate a run's models on its held-out subjects, or model files on any recordings.
    Evaluate(evaluate::Arguments),
    /// Write one printable page on one or several runs or model files, side by side.
    Report(report::Arguments),
    /// Stream one recording through the device's pipeline and print the device's UART lines.
    Replay(replay::Arguments),
    /// Show EMG, scores and labels of a board or a recording on a page in a browser.
    Live(live::Arguments),
    /// Record a person in a guided session on a page in a browser, and tune a model on it.
    Record(record::Arguments),
    /// List the built-in recording protocols, or print one.
    Protocols(built_in::ProtocolArguments),
    /// Write a model's labels and logits for a recording or a window.
    Predict(predict::Arguments),
    /// Score any predicted label sequence against the true one.
    Score(score::Arguments),
    /// Show the header of a model file.
    Info(info::Arguments),
    /// Make the alignment template of a model file anew, from the people whom the model has seen.
    Template(template::Arguments),
    /// Learn the last layer of a model file anew from a few holds of a person.
    Calibrate(calibrate::Arguments),
    /// Move the operating point of a model file: the margins of its confidence gate.
    Gate(gate::Arguments),
    /// Put firmware and a model onto a board with USB, and bind an armband.
    Flash(flash::Arguments),
    /// Ask a board on a serial port: what runs there, what was lost, an alignment, a binding, its operating point.
    Board(board::Arguments),
    /// List the built-in presets, or print one.
    Presets(built_in::PresetArguments),
}

impl Cli {
    /// Parses the command line of this process, or ends it with an error.
    pub fn from_command_line() -> Self {
        Self::try_parse().unwrap_or_else(|error| match absent(&error) {
            Some(advice) => {
                progress::log(&format!("error: {advice}"));
                std::process::exit(error.exit_code())
            }
            None => error.exit(),
        })
    }

    /// Runs the command and returns its exit code; an error is printed on standard error.
    pub fn run(self) -> ExitCode {
        crate::declare_revision();
        interrupt::outlive_file_limit();
        let advice = self.command.advice();
        let result = match self.command {
            #[cfg(feature = "train")]
            Command::Steps(command) => command.run(),
            Command::Data(command) => data::run(command),
            Command::Evaluate(arguments) => evaluate::run(&arguments),
            Command::Report(arguments) => report::run(&arguments),
            Command::Replay(arguments) => replay::run(&arguments),
            Command::Live(arguments) => live::run(&arguments),
            Command::Record(arguments) => record::run(&arguments),
            Command::Protocols(arguments) => built_in::protocols(&arguments),
            Command::Predict(arguments) => predict::run(&arguments),
            Command::Score(arguments) => score::run(arguments),
            Command::Info(arguments) => info::run(&arguments),
            Command::Template(arguments) => template::run(&arguments),
            Command::Calibrate(arguments) => calibrate::run(&arguments),
            Command::Gate(arguments) => gate::run(&arguments),
            Command::Flash(arguments) => flash::run(&arguments),
            Command::Board(arguments) => board::run(&arguments),
            Command::Presets(arguments) => built_in::presets(&arguments),
        };
        match result {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
            Err(error) => {
                // That the old model is kept is a result, not an error.
                let start = if keeps_the_old(&error) { "" } else { "error: " };
                progress::log(&format!("{start}{}", progress::with_causes(&*error)));
                let interrupted = is_interrupt(&error);
                if interrupted {
                    progress::log(advice);
                }
                exit_code(&error, interrupted)
            }
        }
    }
}

pub(crate) const WITHOUT_TRAINING: &str = "this program was built without training; `cargo run --release -- COMMAND` builds and runs all of it";
const WITHOUT_DOWNLOADS: &str = "this program was built without downloads; to build and run it with them:\n\
     cargo run --release --package myointent --no-default-features --features fetch -- data fetch NAME";

/// Advice for a command of a feature that this program was built without.
fn absent(error: &clap::Error) -> Option<&'static str> {
    let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    match name.as_str() {
        "quickstart" | "train" | "quantize" | "export" | "personalize" => Some(WITHOUT_TRAINING),
        "fetch" => Some(WITHOUT_DOWNLOADS),
        _ => None,
    }
}

impl Command {
    /// Advice after an interrupt.
    const fn advice(&self) -> &'static str {
        match self {
            #[cfg(feature = "train")]
            Self::Steps(command) if command.resumes() => {
                "to continue, give the same command and --resume (without --overwrite)"
            }
            _ => "to try again, give the same command",
        }
    }
}

/// Exit code: 130 after Ctrl-C, 2 for wrong arguments, 3 if a tuned or calibrated model is worse, 1 after any other failure.
pub fn exit_code(error: &anyhow::Error, interrupted: bool) -> ExitCode {
    if interrupted {
        ExitCode::from(130)
    } else if keeps_the_old(error) {
        ExitCode::from(KEPT)
    } else if is_wrong_argument(error) {
        ExitCode::from(2)
    } else {
        ExitCode::FAILURE
    }
}

/// Whether the user interrupted.
pub fn is_interrupt(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        #[cfg(feature = "train")]
        if steps::is_interrupt(cause) {
            return true;
        }
        cause.downcast_ref().is_some_and(RunError::is_interrupt)
    })
}

/// Whether a command decided to keep the old model.
fn keeps_the_old(error: &anyhow::Error) -> bool {
    #[cfg(feature = "train")]
    if steps::keeps_the_old(error) {
        return true;
    }
    error.is::<Kept>()
}

/// Decision to keep the old model, with its reason: the new one is worse.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Kept(String);

/// Exit code if a command keeps the old model.
const KEPT: u8 = 3;

/// Whether an argument has an impossible value that the parser accepts.
fn is_wrong_argument(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(PresetError::Missing { .. }))
        || matches!(error.downcast_ref(), Some(ConfigError::Fold { .. }))
}

/// Whether the reader has closed the output: `myointent replay ... | head` is not a failure.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

fn read_model(path: &Path) -> anyhow::Result<Vec<u8>> {
    bounded_read::read_model(path).with_context(|| path.display().to_string())
}

/// Runs the program with the words of a line.
#[cfg(test)]
fn run(line: &str) -> ExitCode {
    let words = ["myointent"].into_iter().chain(line.split(' '));
    let Ok(cli) = Cli::try_parse_from(words) else {
        panic!("{line}");
    };
    cli.run()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_kind_of_file_as_a_model_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.intent");
        std::fs::write(&path, "version https://git-lfs.github.com/spec/v1\n").unwrap();
        let error = format!("{:#}", read_model(&path).unwrap_err());
        for word in ["model.intent", "Git LFS", "git lfs pull"] {
            assert!(error.contains(word), "{error}");
        }
    }
}
