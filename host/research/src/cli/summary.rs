//! `myointent-research summary`: a variant's folds as one evaluation.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::comparison::results::VariantResults;
use crate::comparison::tables::folds;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::report::scores::tables;
use myointent::run::evaluate::Results;

const FILE: &str = "summary.json";

/// Arguments of `summary`.
#[derive(Debug, Args)]
#[command(
    after_help = "DIR has one run folder per fold, evaluated by `myointent-research study` or `evaluate`. Scores are merged by\n\
    subject: means and deviations are over the held-out subjects of all folds. Missing folds are reported. Folds with\n\
    different settings, or with a common held-out subject, are refused. All numbers go to DIR/summary.json.\n\n\
    Example:\n  myointent-research summary runs/study/main"
)]
pub(super) struct Arguments {
    /// Folder of a variant.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print summary.json instead of tables.
    #[arg(long)]
    json: bool,
}

/// The content of summary.json.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    variant: &'a str,
    provenance: String,
    warnings: Vec<String>,
    missing_folds: Vec<usize>,
    held_out_in_fold: BTreeMap<usize, &'a [String]>,
    results: &'a Results,
}

/// Merges the folds, writes summary.json and prints the tables.
///
/// # Errors
/// When a fold has not been evaluated, folds do not belong together or the folder cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let variant = VariantResults::load(&arguments.folder)?;
    let warnings = variant.warnings();
    for warning in &warnings {
        progress::log(&format!("WARNING: {warning}"));
    }
    let summary = Summary {
        variant: &variant.name,
        provenance: variant.provenance(),
        warnings,
        missing_folds: variant.missing_folds(),
        held_out_in_fold: variant
            .runs
            .iter()
            .map(|run| (run.fold().number, run.config.split.held_out.as_slice()))
            .collect(),
        results: &variant.merged,
    };
    let folder = RunFolder::existing(&arguments.folder)?;
    folder.save_json(FILE, &summary)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
    writeln!(out, "{}\n", summary.provenance)?;
    for table in tables(&variant.merged) {
        writeln!(out, "{}", table.plain())?;
    }
    write!(out, "{}", folds([&variant]).table().plain())?;
    writeln!(out, "\nall numbers: {}", folder.file(FILE).display())?;
    Ok(())
}
