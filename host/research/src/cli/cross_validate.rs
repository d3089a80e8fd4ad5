//! `myointent-research cross-validate`: presets compared on everybody, for several seeds.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::bail;
use clap::Args;
use myointent::cli::arguments::{BackendArguments, DataArguments};
use myointent::evaluation::LookAhead;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::write_whole;
use myointent::run::preset::Preset;
use myointent::run::resolve::ConfigError;
use shared::units::MAX_ENTRY_MARGIN;

use super::shell::{line, program, shared_options};
use crate::baselines::settings::find_preset;
use crate::cross_validation::{
    CrossValidation, FoldScore, Job, Merged, differences, people, scores,
};

/// Arguments of `cross-validate`.
#[derive(Debug, Args)]
#[command(
    after_help = "A job is one fold of one preset with one seed: it trains the student (and before it the teacher or\n\
    the ensemble that it learns from) without the people of the fold, and evaluates the integer student on them. A fold has people of\n\
    all data sets found, also of those that the preset does not train on; test people are in none. The seed decides folds,\n\
    validation people and training. A person's value is the mean over seeds; intervals are over people.\n\n\
    Jobs are independent. An interrupted job continues where it stopped; a finished one is not repeated. Tables are printed\n\
    for the folds that all presets have, and written to the folder when these are all folds.\n\n\
    Examples:\n  \
    myointent-research cross-validate --preset cpu --preset mine.toml --seeds 42,7 --data recordings\n  \
    myointent-research cross-validate --preset cpu --list | sh       job by job, or pass the lines to a scheduler"
)]
pub(super) struct Arguments {
    /// Presets to compare, the first one with all others: built-in ones, or TOML files. Repeat the option.
    #[arg(long, required = true)]
    preset: Vec<String>,
    /// Seeds, separated by commas; each preset is trained with each.
    #[arg(long, value_delimiter = ',', default_value = "42,7")]
    seeds: Vec<u64>,
    /// Number of folds.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(2..))]
    folds: u8,
    /// Also evaluate with these confidence gates, separated by commas: by how much the mean logit of open, close, ...
    /// has to exceed all others for the label to become this class. Nothing is trained again.
    #[arg(long, value_name = "MARGINS", value_delimiter = ',', value_parser = entry_margin)]
    entry_margins: Vec<f32>,
    /// Number of the only fold to run, 1 first; all if not given.
    #[arg(long)]
    fold: Option<u8>,
    /// Folder; run folders are PRESET/seed-S/fold-K in it.
    #[arg(long, value_name = "DIR", default_value = "runs/cross-validation")]
    out: PathBuf,
    /// Print the jobs as commands, one per line, without running them.
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Runs the jobs, or lists them; prints and writes the tables when no job is left.
///
/// # Errors
/// When the recordings, a preset or a folder cannot be used, or a job fails.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let presets = presets(&arguments.preset)?;
    let of = usize::from(arguments.folds);
    if let Some(number) = arguments.fold.map(usize::from)
        && !(1..=of).contains(&number)
    {
        return Err(ConfigError::Fold { number, of }.into());
    }
    let mut out = std::io::stdout().lock();
    if arguments.list {
        for (name, seed, fold) in selected(arguments) {
            writeln!(out, "{}", command(arguments, name, seed, fold))?;
        }
        return Ok(());
    }
    // All data sets, whatever the presets train on: everybody is evaluated.
    let mut readable = presets[0].clone();
    readable.data.data_sets.clear();
    let library = Arc::new(arguments.data.load(&readable)?);
    let data = arguments.data.folder();
    let interrupt = Interrupt::listen();
    let validation = CrossValidation {
        folder: &arguments.out,
        folds: of,
        entry_margins: margins(arguments).collect(),
        library,
        data: data.as_deref(),
        strict: arguments.data.strict,
        device: arguments.backend.device(),
        interrupt: &interrupt,
    };
    let job = |preset: &Preset, seed, fold: u8| Job {
        preset: Preset {
            seed,
            ..preset.clone()
        },
        fold: fold.into(),
    };
    for seed in &arguments.seeds {
        for fold in folds(arguments) {
            for preset in &presets {
                validation.run(&job(preset, *seed, fold))?;
            }
        }
    }
    // Other folds and seeds may have been run by other commands. A fold counts if all presets have it.
    let mut results = vec![Vec::new(); presets.len()];
    let (mut counted, mut left) = (0, 0);
    for &seed in &arguments.seeds {
        for fold in 1..=arguments.folds {
            let all: Result<Option<Vec<_>>, _> = presets
                .iter()
                .map(|preset| validation.done(&job(preset, seed, fold)))
                .collect();
            let Some(all) = all? else {
                left += 1;
                continue;
            };
            counted += 1;
            for (own, scores) in results.iter_mut().zip(all) {
                own.push((seed, scores));
            }
        }
    }
    if counted == 0 {
        progress::log("no tables yet: no fold has been run with all presets");
        return Ok(());
    }
    let merged = merged(arguments, &presets, &results);
    for table in [scores(&merged), differences(&merged)] {
        writeln!(out, "{}", table.plain())?;
    }
    if left > 0 {
        progress::log(&format!(
            "these are {counted} of {} folds, not everybody: nothing was written; give the same command without --fold",
            counted + left
        ));
        return Ok(());
    }
    for path in write(&arguments.out, &merged)? {
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}

/// The presets by their names, which are folders.
fn presets(names: &[String]) -> anyhow::Result<Vec<Preset>> {
    let mut presets: Vec<Preset> = Vec::new();
    for name in names {
        let (preset, _) = find_preset(name)?;
        if presets.iter().any(|other| other.name == preset.name) {
            bail!(
                "two presets have the name {:?}: change `name` in one of them",
                preset.name
            );
        }
        presets.push(preset);
    }
    let classes = presets[0].classes;
    if let Some(other) = presets.iter().find(|preset| preset.classes != classes) {
        bail!(
            "{} has {classes} classes and {} has {}: compare presets of one vocabulary",
            presets[0].name,
            other.name,
            other.classes
        );
    }
    Ok(presets)
}

fn entry_margin(text: &str) -> Result<f32, String> {
    let margin = text.parse().ok();
    margin
        .filter(|margin| (0.0..=MAX_ENTRY_MARGIN).contains(margin))
        .ok_or_else(|| format!("expected 0 to {MAX_ENTRY_MARGIN}"))
}

/// The preset's own confidence gate, then those asked for.
fn margins(arguments: &Arguments) -> impl Iterator<Item = Option<f32>> {
    let asked = arguments.entry_margins.iter().copied().map(Some);
    std::iter::once(None).chain(asked)
}

fn folds(arguments: &Arguments) -> impl Iterator<Item = u8> {
    let only = arguments.fold;
    (1..=arguments.folds).filter(move |&fold| only.is_none_or(|only| only == fold))
}

/// Preset, seed and fold of each job.
fn selected(arguments: &Arguments) -> impl Iterator<Item = (&str, u64, u8)> {
    arguments.seeds.iter().flat_map(move |&seed| {
        folds(arguments).flat_map(move |fold| {
            let presets = arguments.preset.iter();
            presets.map(move |preset| (preset.as_str(), seed, fold))
        })
    })
}

/// The shell command of one job, to be run in the current folder.
fn command(arguments: &Arguments, preset: &str, seed: u64, fold: u8) -> String {
    let mut words = vec![program(), "cross-validate".to_owned()];
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    option("preset", preset.to_owned());
    option("seeds", seed.to_string());
    option("folds", arguments.folds.to_string());
    option("fold", fold.to_string());
    option("out", arguments.out.display().to_string());
    if !arguments.entry_margins.is_empty() {
        let margins: Vec<String> = arguments.entry_margins.iter().map(f32::to_string).collect();
        option("entry-margins", margins.join(","));
    }
    if let Some(data) = arguments.data.folder() {
        option("data", data.display().to_string());
    }
    words.extend(shared_options(&arguments.data, arguments.backend));
    line(&words)
}

/// Every preset under both aggregation modes and each confidence gate.
fn merged<'a>(
    arguments: &Arguments,
    presets: &'a [Preset],
    results: &'a [Vec<(u64, Vec<FoldScore>)>],
) -> Vec<Merged<'a>> {
    let mut merged = Vec::new();
    for (preset, own) in presets.iter().zip(results) {
        for margin in margins(arguments) {
            for look_ahead in [LookAhead::AllRows, LookAhead::SameInstant] {
                let scores = own
                    .iter()
                    .flat_map(|(seed, scores)| scores.iter().map(|score| (*seed, score)));
                merged.push(Merged::new(&preset.name, look_ahead, margin, scores));
            }
        }
    }
    merged
}

/// Writes the tables, and a row for each person, seed, preset and mode.
fn write(folder: &Path, merged: &[Merged<'_>]) -> anyhow::Result<[PathBuf; 2]> {
    let page = folder.join("tables.md");
    let tables = [scores(merged), differences(merged)];
    write_whole(
        &page,
        tables.map(|table| table.markdown()).join("\n").as_bytes(),
    )?;
    let rows = folder.join("people.csv");
    write_whole(&rows, &people(merged).csv()?)?;
    Ok([page, rows])
}
