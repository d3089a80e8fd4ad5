//! `myointent data fetch` of a program built without downloads: lists the data sets, and says what to build. Twin of `fetch`.

use std::io::Write as _;

use anyhow::bail;
use clap::Args;

use super::data::published;

/// Arguments of `data fetch`.
#[derive(Args, Debug)]
#[command(
    after_help = "Without NAME, lists the data sets. This program was built without downloads: with NAME, it prints the command that has them."
)]
pub struct Arguments {
    /// The data set, by its name in `myointent data fetch`, and options
    #[arg(
        value_name = "NAME",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    words: Vec<String>,
}

/// Lists the data sets.
///
/// # Errors
/// When one is asked for: the command that downloads it.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.words.is_empty() {
        return Ok(std::io::stdout().write_all(published().plain().as_bytes())?);
    }
    bail!(
        "this program was built without downloads; to build and run it with them:\n\
         cargo run --release --package myointent --no-default-features --features fetch -- data fetch {}",
        arguments.words.join(" ")
    );
}
