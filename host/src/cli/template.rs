//! `myointent template`: the alignment template of a model file.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use crate::cli::arguments::every_recording;
use crate::cli::output::refuse_existing;
use crate::cli::read_model;
use evaluation::template::model_with_template;
use execution::run_folder::write_whole;

/// Arguments of `template`.
#[derive(Debug, Args)]
#[command(
    after_help = "The template says what an open hand looks like over the electrodes; the device aligns the armband by it\n\
    (docs/alignment.md). `quantize` writes one of the training people into every model file. This command is for files without\n\
    one, and changes nothing else in them.\n\n\
    Example:\n  myointent template models/three-class.intent --data DIR"
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// Folder of the recordings that the model was trained on.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// File to write; there must be none of this name.
    ///
    /// The model file itself if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Refuse damaged files instead of leaving them out.
    #[arg(long)]
    strict: bool,
}

/// Writes the model file with its template.
///
/// # Errors
/// When the model or the recordings are refused, or too few of its people open the hand.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    if let Some(out) = &arguments.out {
        refuse_existing(out)?;
    }
    let bytes = read_model(path)?;
    let library = every_recording(&arguments.data, arguments.strict)?;
    let (file, people) = model_with_template(&bytes, &library)?;
    let out = arguments.out.as_ref().unwrap_or(path);
    write_whole(out, &file)?;
    writeln!(
        std::io::stdout(),
        "{}: template of {people} people who open the hand",
        out.display()
    )?;
    Ok(())
}
