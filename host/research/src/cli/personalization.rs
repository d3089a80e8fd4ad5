//! `myointent-research personalization`: measures the gain of a person's own recordings, by their duration.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use execution::interrupt::Interrupt;
use execution::run_folder::RunFolder;
use recordings::split::predefined::is_test;
use recordings::{LoadOptions, load};
use shared::model::file::Model;
use training::backend::BackendArguments;
use training::run::quantize::MODEL;

use super::{print_tables, write_tables};
use crate::personalization::{Measured, Measurement, curves, people};

#[derive(Debug, Args)]
#[command(
    after_help = "Each model is tuned, and calibrated as by `myointent calibrate`, for each person whom it has not seen, test people left out,\n\
    on the first half of the holds of each motion, and judged on the other half; what is judged is the same for all amounts. An amount\n\
    is of gestures and rest; other movement is learned from with `inf` only. A file for each person is kept in the folder: an\n\
    interrupted command continues.\n\n\
    Example:\n  \
    myointent-research personalization runs/cross-validation/cpu/seed-42/fold-* --data DIR"
)]
pub(super) struct Arguments {
    /// Run folders, of a cross-validation for example: each has its model and people whom it has not seen.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Folder of the recordings.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Seconds to learn from, separated by commas; inf for all of the half.
    #[arg(
        long,
        value_name = "SECONDS",
        value_delimiter = ',',
        default_value = "30,60,120,180,300"
    )]
    amounts: Vec<f64>,
    /// Folder of a file for each person and of the tables.
    #[arg(long, value_name = "DIR", default_value = "runs/personalization")]
    out: PathBuf,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Measures all people, prints and writes the tables.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let folder = RunFolder::open(&arguments.out)?;
    let device = arguments.backend.device()?;
    let library = load(&arguments.data, &LoadOptions::default())?;
    let interrupt = Interrupt::listen();
    let measurement = Measurement {
        folder: &folder,
        library: &library,
        amounts: &arguments.amounts,
        device,
        interrupt: &interrupt,
    };
    let subjects = library.subjects();
    let wanted: Vec<_> = subjects.into_iter().filter(|own| !is_test(own)).collect();
    let mut measured: Vec<Measured> = Vec::new();
    let mut tried = BTreeSet::new();
    for run in &arguments.runs {
        let path = run.join(MODEL);
        let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
        let model = Model::parse(&bytes).with_context(|| path.display().to_string())?;
        let seen: Vec<&str> = model.header.provenance.subjects_seen.iter().collect();
        for subject in wanted.iter().filter(|own| !seen.contains(&&own[..])) {
            if tried.insert(subject) {
                measured.extend(measurement.person(&bytes, subject)?);
            }
        }
    }
    measured.sort_by(|a, b| a.subject.cmp(&b.subject));
    let tables = curves(&measured, &arguments.amounts);
    let mut out = std::io::stdout().lock();
    print_tables(&tables, &mut out)?;
    let people = people(&measured, &arguments.amounts);
    let [_, rows] = write_tables(folder.path(), &tables, &people)?;
    writeln!(out, "{}", rows.display())?;
    Ok(())
}
