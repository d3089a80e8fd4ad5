//! `myointent-research summary`: the folds of a protocol as one evaluation.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::comparison::{Outcome, folds};
use myointent::execution::run_folder::RunFolder;
use myointent::report::scores::tables;
use myointent::run::evaluate::Results;

const FILE: &str = "summary.json";

/// Arguments of `summary`.
#[derive(Debug, Args)]
#[command(
    after_help = "DIR holds a run folder for each fold, evaluated by `myointent evaluate`. Scores are put together by\n\
    subject: deviations are over all people left out, whatever the fold. Folds that are missing are told; folds\n\
    that were not run alike, or that leave somebody out twice, are refused. All numbers go to DIR/summary.json.\n\n\
    Example:\n  myointent-research summary studies/all/main"
)]
pub struct Arguments {
    /// Folder of the folds.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print summary.json instead of tables.
    #[arg(long)]
    json: bool,
}

/// What summary.json keeps.
#[derive(Debug, Serialize)]
struct Gathered<'a> {
    variant: &'a str,
    provenance: String,
    warnings: Vec<String>,
    missing_folds: Vec<usize>,
    left_out_in_fold: BTreeMap<usize, &'a [String]>,
    results: &'a Results,
}

/// Puts the folds together, shows the tables and writes summary.json.
///
/// # Errors
/// When a fold is not judged, folds do not belong together or the folder cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let variant = Outcome::load(&arguments.folder)?;
    let warnings = variant.warnings();
    for warning in &warnings {
        eprintln!("WARNING: {warning}");
    }
    let gathered = Gathered {
        variant: &variant.name,
        provenance: variant.provenance(),
        warnings,
        missing_folds: variant.missing(),
        left_out_in_fold: variant
            .runs
            .iter()
            .map(|run| (run.fold().number, run.config.split.held_out.as_slice()))
            .collect(),
        results: &variant.results,
    };
    let folder = RunFolder::existing(&arguments.folder)?;
    folder.save_json(FILE, &gathered)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&gathered)?)?;
        return Ok(());
    }
    writeln!(out, "{}\n", gathered.provenance)?;
    for table in tables(&variant.results) {
        writeln!(out, "{}", table.plain())?;
    }
    write!(out, "{}", folds([&variant]).table().plain())?;
    writeln!(out, "\nall numbers: {}", folder.file(FILE).display())?;
    Ok(())
}
