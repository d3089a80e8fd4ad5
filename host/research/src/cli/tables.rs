//! `myointent-research tables`: a study's tables, from the results in its run folders.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use crate::comparison::results::{StudyResults, VariantResults};
use crate::comparison::tables::page;
use myointent::execution::progress;
use myointent::execution::run_folder::write_whole;

/// Arguments of `tables`.
#[derive(Debug, Args)]
#[command(
    after_help = "STUDY has run folders VARIANT/fold-K, evaluated by `myointent-research study` or `evaluate`. The tables use the\n\
    variants main, wrist, scratch, pretrained, fine-tuned, lora, window-N and student-WxL; in place of a missing one\n\
    stands the command that runs it. A variant with another name gets a table of its own. Writes tables.md, and for each\n\
    table a CSV whose last column names the runs behind the row.\n\n\
    Example:\n  myointent-research tables runs/study --out tables"
)]
pub(super) struct Arguments {
    /// Folder of the study.
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// Folder to write to.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Write tables although a run was made by a program whose source had changes that were not committed. Nobody can
    /// make such numbers again.
    #[arg(long)]
    allow_dirty: bool,
}

/// Writes the tables.
///
/// # Errors
/// When runs cannot be read, folds do not belong together or the folder cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let study = StudyResults::load(&arguments.study)?;
    if !arguments.allow_dirty {
        study.refuse_dirty()?;
    }
    for warning in study.variants.values().flat_map(VariantResults::warnings) {
        progress::log(&format!("WARNING: {warning}"));
    }
    let page = page(&study);
    let folder = &arguments.out;
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut out = std::io::stdout().lock();
    for sheet in page.sheets() {
        let path = folder.join(format!("{}.csv", sheet.name));
        write_whole(&path, &sheet.csv()?)?;
        writeln!(out, "{}", path.display())?;
    }
    let path = folder.join("tables.md");
    write_whole(&path, page.markdown().as_bytes())?;
    writeln!(out, "{}", path.display())?;
    Ok(())
}
