//! `myointent gate`: the confidence gate of a model file.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use shared::model::file::Model;

use crate::cli::output::refuse_existing;
use crate::cli::read_model;
use execution::run_folder::write_whole;

/// Arguments of `gate`.
#[derive(Debug, Args)]
#[command(
    after_help = "A higher margin gives fewer false activations and, at some point, fewer gestures; docs/results.md has the curve.\n\n\
    Example:\n  myointent gate models/three-class.intent --other 1 --out strict.intent"
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// By how much the mean logit of open, close, ... has to exceed that of every other intent, 0 to 50.
    #[arg(long, value_name = "MARGIN", required_unless_present = "other")]
    entry: Option<f32>,
    /// By how much it has to exceed that of movement outside the vocabulary, -50 to 50.
    #[arg(long, value_name = "MARGIN", allow_negative_numbers = true)]
    other: Option<f32>,
    /// File to write; there must be none of this name.
    ///
    /// The model file itself if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the model file with its new gate.
///
/// # Errors
/// When the model or a margin is refused, or the file cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    if let Some(out) = &arguments.out {
        refuse_existing(out)?;
    }
    let bytes = read_model(path)?;
    let file = Model::with_gate(&bytes, arguments.entry, arguments.other)
        .with_context(|| path.display().to_string())?;
    let out = arguments.out.as_ref().unwrap_or(path);
    write_whole(out, &file)?;
    writeln!(std::io::stdout(), "{}", out.display())?;
    Ok(())
}
