//! `myointent gate`: the operating point of a model file.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use shared::model::file::Model;
use shared::stream::smoother::Reaction;

use crate::cli::output::refuse_existing;
use crate::cli::read_model;
use execution::run_folder::write_whole;

#[derive(Debug, Args)]
#[command(
    after_help = "docs/results.md has the curve of reactions and margins.\n\n\
    Examples:\n  myointent gate models/three-class.intent --reaction steady --out steady.intent\n  \
    myointent gate models/three-class.intent --other 1 --out strict.intent"
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// How soon a label changes: `fast`, `balanced`, `steady` or `late`. The sooner, the more false activations.
    #[arg(long, value_name = "REACTION", value_parser = reaction, required_unless_present_any = ["entry", "other"])]
    reaction: Option<Reaction>,
    /// By how much the mean logit of open, close, ... has to exceed that of every other intent, 0 to 50.
    ///
    /// A higher margin gives fewer false activations and, at some point, fewer gestures. It comes before the reaction's own.
    #[arg(long, value_name = "MARGIN")]
    entry: Option<f32>,
    /// By how much it has to exceed that of movement outside the vocabulary, -50 to 50.
    #[arg(long, value_name = "MARGIN", allow_negative_numbers = true)]
    other: Option<f32>,
    /// File to write; it must not exist.
    ///
    /// The model file itself if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn reaction(name: &str) -> Result<Reaction, String> {
    Reaction::from_name(name)
        .ok_or_else(|| format!("expected {}", Reaction::ALL.map(Reaction::name).join(", ")))
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    arguments.out.as_deref().map_or(Ok(()), refuse_existing)?;
    let bytes = read_model(path)?;
    let (entry, other) = (arguments.entry, arguments.other);
    let file = Model::with_gate(&bytes, entry, other, arguments.reaction)
        .with_context(|| path.display().to_string())?;
    let out = arguments.out.as_ref().unwrap_or(path);
    write_whole(out, &file)?;
    writeln!(std::io::stdout(), "{}", out.display())?;
    Ok(())
}
