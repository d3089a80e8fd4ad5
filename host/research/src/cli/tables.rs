//! `myointent-research tables`: a study's tables, from its run folders alone.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use crate::comparison::{self, tables};
use myointent::execution::run_folder::{RunFolder, write_whole};

/// Arguments of `tables`.
#[derive(Debug, Args)]
#[command(
    after_help = "STUDY holds VARIANT/fold-K, each evaluated by `myointent evaluate`. Tables are made of the variants main,\n\
    wrist, scratch, pretrained, fine-tuned, lora, window-N and student-WxL; what is missing is told in its place, and variants of\n\
    other names get a table of their own. Writes tables.md and a CSV for each table, whose last column says which\n\
    runs a row comes from.\n\n\
    Example:\n  myointent-research tables studies/all --out tables"
)]
pub struct Arguments {
    /// Folder of the variants.
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// Folder to write to.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Writes the tables.
///
/// # Errors
/// When runs cannot be read or do not belong together, or the folder cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let study = comparison::load(&arguments.study)?;
    for warning in study
        .variants
        .values()
        .flat_map(comparison::Outcome::warnings)
    {
        eprintln!("WARNING: {warning}");
    }
    let tables = tables(&study);
    let folder = RunFolder::open(&arguments.out)?;
    let mut out = std::io::stdout().lock();
    for sheet in tables.sheets() {
        let path = folder.file(&format!("{}.csv", sheet.name));
        write_whole(&path, &sheet.csv()?)?;
        writeln!(out, "{}", path.display())?;
    }
    let page = folder.file("tables.md");
    write_whole(&page, tables.markdown().as_bytes())?;
    writeln!(out, "{}", page.display())?;
    Ok(())
}
