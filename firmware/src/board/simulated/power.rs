//! Restarts of the program: a reset is a new process, for nothing but flash is
//! kept by it.

use std::fmt::Display;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use anyhow::Context as _;
use clap::{Parser, ValueEnum as _};

use super::hardware;
use crate::messages::pin_state::PinState;
use crate::reset_reason::ResetReason;

/// Runs the board's program on the PC, in virtual time, with an armband and a person that do what a scenario says.
///
/// Writes the lines of its UART to `uart0.out` and the levels of its pins to `uart2.out`.
#[derive(Parser, Clone)]
#[command(version, args_override_self = true)]
pub struct Arguments {
    /// The scenario.
    #[arg(value_name = "SCENARIO.toml")]
    pub scenario: PathBuf,
    /// Content of the model's region; written when it changes.
    #[arg(long, value_name = "FILE.intent")]
    pub model: PathBuf,
    /// Content of the installation's journal; written when it changes.
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
    /// Model file that the person installs.
    #[arg(long, value_name = "FILE.intent")]
    pub install: Option<PathBuf>,
    /// Samples that the armband streams: 8 signed bytes a sample, 200 samples a second.
    #[arg(long, value_name = "FILE.i8")]
    pub samples: PathBuf,
    /// Content of the bound armband's page; written when it changes.
    #[arg(long, value_name = "FILE")]
    pub page: PathBuf,
    /// Content of the calibration's page; written when it changes.
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Folder for what is written.
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Socket of a Bluetooth controller that another program simulates, with the armbands behind it.
    #[cfg(unix)]
    #[arg(long, value_name = "SOCKET", requires = "slowed")]
    pub hci: Option<PathBuf>,
    /// Follows the PC's time, so many times slower, and sends standard input to the UART. A reset ends the program.
    #[arg(long, value_name = "FACTOR", value_parser = clap::value_parser!(u32).range(1..))]
    pub slowed: Option<u32>,
    /// Why the program starts, once it has started before.
    #[arg(long, hide = true, requires = "elapsed_us")]
    pub reset: Option<ResetReason>,
    /// Microseconds of all starts before.
    #[arg(long, hide = true, default_value_t = 0)]
    pub elapsed_us: u64,
    /// Number of earlier starts of the program.
    #[arg(long, hide = true, default_value_t = 0)]
    pub starts: usize,
    /// Notifications that the armband has sent before.
    #[arg(long, hide = true, default_value_t = 0)]
    pub sent: usize,
}

static ARGUMENTS: OnceLock<Arguments> = OnceLock::new();

/// Keeps the arguments for the next start.
pub fn keep(arguments: Arguments) -> &'static Arguments {
    ARGUMENTS.get_or_init(|| arguments)
}

/// Makes the outputs safe, writes a message, and resets, as a board does after a panic.
pub fn fail(message: &dyn Display) -> ! {
    hardware::set_levels(PinState::SAFE);
    let message = message.to_string().replace('\n', " ");
    let line = format!("# {message}\r\n");
    hardware::write_line(line.as_bytes(), hardware::now_us());
    reset(ResetReason::Software)
}

/// Starts the program anew, at this instant of the scenario.
pub fn reset(reason: ResetReason) -> ! {
    let code = start_again(reason).unwrap_or_else(|error| {
        eprintln!("error: the board cannot start again: {error:#}");
        1
    });
    std::process::exit(code)
}

fn start_again(reason: ResetReason) -> anyhow::Result<i32> {
    let Some(arguments) = ARGUMENTS.get() else {
        anyhow::bail!("it was not started");
    };
    anyhow::ensure!(arguments.slowed.is_none(), "the PC's time has gone on");
    let elapsed = arguments.elapsed_us + hardware::now_us();
    let reason = reason.to_possible_value().context("no such reason")?;
    let mut command = Command::new(std::env::current_exe()?);
    let status = command
        .args(std::env::args_os().skip(1))
        .args(["--reset", reason.get_name()])
        .args(["--elapsed-us", &elapsed.to_string()])
        .args(["--starts", &(arguments.starts + 1).to_string()])
        .args(["--sent", &hardware::packets_sent().to_string()])
        .status()?;
    Ok(status.code().unwrap_or(1))
}
