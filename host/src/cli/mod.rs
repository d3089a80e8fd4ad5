//! The command line: parse and dispatch; one file a subcommand.

pub mod arguments;
pub mod data;
pub mod distill;
pub mod evaluate;
pub mod export;
pub mod info;
pub mod predict;
pub mod presets;
pub mod quantize;
pub mod quickstart;
pub mod replay;
pub mod score;
pub mod train;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::execution::run_folder::RunError;
use crate::run::StepError;

/// Intent detection from Myo recordings: train, distil, quantize, measure, replay.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    long_about = "Turns recordings of a Myo armband (8 channels, 200 Hz) into a model file that a small board runs,\n\
                  and shows how well that model detects intent on people it has never seen.",
    after_help = "Start here:\n  myointent quickstart                     everything in one go, in a few minutes\n  \
                  myointent replay models/three-class.intent RECORDING.npy   what the board would say\n\n\
                  Step by step, each into the same run folder:\n  myointent train --preset cpu --data DIR --run runs/mine\n  \
                  myointent distill --run runs/mine\n  myointent quantize --run runs/mine\n  myointent evaluate --run runs/mine\n\n\
                  Exit codes: 0 done, 1 failed, 2 wrong arguments, 130 interrupted (continue with --resume)."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// All of it in one go, at a size that fits two cores in a few minutes.
    Quickstart(quickstart::Arguments),
    /// Look at recordings, or make synthetic ones.
    #[command(subcommand)]
    Data(data::Command),
    /// Train the teacher: the masked transformer.
    Train(train::Arguments),
    /// Train the student from the teacher and the labels.
    Distill(distill::Arguments),
    /// Write the student as a model file of integers.
    Quantize(quantize::Arguments),
    /// Write the teacher's weights as safetensors, under the reference's names.
    Export(export::Arguments),
    /// Judge teacher, float student and integer student on the people left out.
    Evaluate(evaluate::Arguments),
    /// Stream one recording through the device's pipeline and print the device's UART lines.
    Replay(replay::Arguments),
    /// Write a model's logits and labels over a recording or a window.
    Predict(predict::Arguments),
    /// Measure any predicted label sequence against the true one.
    Score(score::Arguments),
    /// Show what is in a model file.
    Info(info::Arguments),
    /// List the built-in presets, or print one.
    Presets(presets::Arguments),
}

impl Cli {
    /// Runs the command and says how it ended.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let result = match self.command {
            Command::Quickstart(arguments) => quickstart::run(&arguments),
            Command::Data(command) => data::run(command),
            Command::Train(arguments) => train::run(&arguments),
            Command::Distill(arguments) => distill::run(&arguments),
            Command::Quantize(arguments) => quantize::run(&arguments),
            Command::Export(arguments) => export::run(&arguments),
            Command::Evaluate(arguments) => evaluate::run(&arguments),
            Command::Replay(arguments) => replay::run(&arguments),
            Command::Predict(arguments) => predict::run(&arguments),
            Command::Score(arguments) => score::run(arguments),
            Command::Info(arguments) => info::run(&arguments),
            Command::Presets(arguments) => presets::run(&arguments),
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

/// 130 after Ctrl-C, 1 after any other failure.
#[must_use]
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    let interrupted = matches!(error.downcast_ref(), Some(RunError::Interrupted { .. }))
        || error
            .downcast_ref::<StepError>()
            .is_some_and(StepError::is_interrupt);
    if interrupted {
        ExitCode::from(130)
    } else {
        ExitCode::FAILURE
    }
}

/// `myointent replay ... | head` ends well.
#[must_use]
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}
