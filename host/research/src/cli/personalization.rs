//! `myointent-research personalization`: measures the gain of a person's own recordings, by their duration.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use execution::interrupt::Interrupt;
use execution::run_folder::{RunFolder, write_whole};
use recordings::split::predefined::is_test;
use recordings::{Library, LoadOptions, load};
use shared::model::file::Model;
use training::backend::BackendArguments;
use training::run::personalize::TuningSettings;
use training::run::quantize::MODEL;

use crate::personalization::{Measured, Measurement, curves, people, rule};

/// Arguments of `personalization`.
#[derive(Debug, Args)]
#[command(
    after_help = "Each model is tuned, and calibrated as by `myointent calibrate`, for each person whom it has not seen, test people left out,\n\
    on the first half of the holds of each motion, and judged on the other half; what is judged is the same for all amounts. Then as\n\
    `myointent personalize` does it: a third of the amount is held back, and the old model is kept unless the new one is not worse on\n\
    it. An amount is of gestures and rest; other movement is learned from with `inf` only. A file for each person is kept in the\n\
    folder: an interrupted command continues.\n\n\
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
    /// People to measure: all, or every other one of each data set, so that settings can be chosen on one half and
    /// reported on the other.
    #[arg(long, value_enum, default_value_t = Half::All)]
    half: Half,
    /// Leave out what `personalize` keeps and writes, which takes as long again.
    #[arg(long)]
    without_rule: bool,
    /// Data sets to leave out, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    without: Vec<String>,
    /// Steps of the tuning.
    #[arg(long, default_value_t = TuningSettings::default().steps)]
    steps: usize,
    /// Peak learning rate.
    #[arg(long, default_value_t = TuningSettings::default().learning_rate)]
    learning_rate: f64,
    /// Share of the shipped model's outputs in the targets (learning without forgetting), 0 to 1.
    #[arg(long, default_value_t = TuningSettings::default().keep)]
    keep: f64,
    /// Folder of a file for each person and of the tables.
    #[arg(long, value_name = "DIR", default_value = "runs/personalization")]
    out: PathBuf,
    #[command(flatten)]
    backend: BackendArguments,
}

/// People who are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Half {
    All,
    First,
    Second,
}

/// Measures all people, prints and writes the tables.
///
/// # Errors
/// When a model or the recordings are refused, a file cannot be written or the user interrupts.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let folder = RunFolder::open(&arguments.out)?;
    let device = arguments.backend.device()?;
    let library = load(&arguments.data, &LoadOptions::default())?;
    let interrupt = Interrupt::listen();
    let settings = TuningSettings {
        steps: arguments.steps,
        learning_rate: arguments.learning_rate,
        keep: arguments.keep,
        ..TuningSettings::default()
    };
    let measurement = Measurement {
        folder: &folder,
        library: &library,
        amounts: &arguments.amounts,
        settings: &settings,
        with_rule: !arguments.without_rule,
        device,
        interrupt: &interrupt,
    };
    let wanted = wanted(&library, arguments);
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
    let mut tables = curves(&measured, &arguments.amounts).to_vec();
    if !arguments.without_rule {
        tables.push(rule(&measured, &arguments.amounts));
    }
    let mut out = std::io::stdout().lock();
    for table in &tables {
        writeln!(out, "{}", table.plain())?;
    }
    let markdown: Vec<String> = tables.iter().map(|table| table.markdown()).collect();
    write_whole(&folder.file("tables.md"), markdown.join("\n").as_bytes())?;
    write_whole(
        &folder.file("people.csv"),
        &people(&measured, &arguments.amounts).csv()?,
    )?;
    writeln!(out, "{}", folder.file("people.csv").display())?;
    Ok(())
}

/// Selects the people to measure.
fn wanted(library: &Library, arguments: &Arguments) -> Vec<String> {
    let set = |subject: &str| subject.split_once('/').map_or("", |own| own.0).to_owned();
    let mut wanted = Vec::new();
    let mut last = (String::new(), 0);
    for subject in library.subjects() {
        if is_test(&subject) || arguments.without.contains(&set(&subject)) {
            continue;
        }
        last = if last.0 == set(&subject) {
            (last.0, last.1 + 1)
        } else {
            (set(&subject), 0)
        };
        let chosen = match arguments.half {
            Half::All => true,
            Half::First => last.1 % 2 == 0,
            Half::Second => last.1 % 2 == 1,
        };
        if chosen {
            wanted.push(subject);
        }
    }
    wanted
}
