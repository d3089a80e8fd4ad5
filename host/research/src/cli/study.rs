//! `myointent-research study`: the paper's comparisons, job by job.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::shell::{line, program, shared_options};
use crate::baselines::settings::find_preset;
use crate::comparison::study::Study;
use crate::comparison::variant::{Variant, data_sets};
use myointent::cli::arguments::{BackendArguments, DataArguments};
use myointent::dataset::folds::Protocol;
use myointent::execution::interrupt::Interrupt;
use myointent::run::resolve::ConfigError;

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(
    after_help = "A job is one fold of one variant. Jobs are independent, except that `pretrained`, `fine-tuned` and `lora` need\n\
    `pretraining`. An interrupted job continues where it stopped; an evaluated one is skipped.\n\n\
    Examples:\n  \
    myointent-research study --data recordings                   all jobs, one after the other\n  \
    myointent-research study --data recordings --list | sh       the same, or pass the lines to a scheduler\n  \
    myointent-research study --data recordings --study runs/sizes --variant student-64x2,student-96x3\n  \
    myointent-research tables runs/study --out tables            the results"
)]
pub(super) struct Arguments {
    /// Preset that the variants modify: study, a preset of `myointent`, or a TOML file.
    #[arg(long, default_value = "study")]
    preset: String,
    /// Folder of the study; run folders are VARIANT/fold-K in it.
    #[arg(long, value_name = "DIR", default_value = "runs/study")]
    study: PathBuf,
    /// Cross-validation over subjects: `loso` (leave one subject out), or `4-fold` with any number.
    #[arg(long, default_value = "4-fold")]
    protocol: Protocol,
    /// Variants to run; the paper's comparisons if not given. Students of eight sizes, `student-48x2` (width
    /// and layers) to `student-128x3`, run when named.
    #[arg(long, value_delimiter = ',')]
    variant: Vec<Variant>,
    /// Number of the only fold to run, 1 first; all if not given.
    #[arg(long)]
    fold: Option<usize>,
    /// Print the jobs as commands, one per line, without running them.
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Runs the jobs, or lists them.
///
/// # Errors
/// When the recordings, the preset or a folder cannot be used, or a job fails.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let (preset, baselines) = find_preset(&arguments.preset)?;
    let variants = if arguments.variant.is_empty() {
        &Variant::ALL[..]
    } else {
        &arguments.variant
    };
    // Variants use other data sets than the preset that they modify.
    let mut readable = preset.clone();
    readable.data.data_sets = data_sets(variants, &preset);
    let device = arguments.backend.device()?;
    let library = Arc::new(arguments.data.load(&readable)?);
    let data = arguments.data.folder();
    let study = Study {
        folder: &arguments.study,
        preset: &preset,
        protocol: arguments.protocol,
        baselines: &baselines,
        library,
        data: data.as_deref(),
        strict: arguments.data.strict,
        device,
        interrupt: &interrupt,
    };
    let mut out = std::io::stdout().lock();
    for &variant in variants {
        let folds = study.folds(variant)?;
        let selected = |fold: &Option<usize>| arguments.fold.is_none() || *fold == arguments.fold;
        let jobs: Vec<_> = folds
            .iter()
            .copied()
            .filter(|fold| !variant.has_folds() || selected(fold))
            .collect();
        if jobs.is_empty() {
            return Err(ConfigError::Fold {
                number: arguments.fold.unwrap_or_default(),
                of: folds.len(),
            }
            .into());
        }
        for fold in jobs {
            if arguments.list {
                writeln!(out, "{}", command(arguments, variant, fold))?;
            } else {
                study.run(variant, fold)?;
            }
        }
    }
    Ok(())
}

/// The shell command of one job, to be run in the current folder.
fn command(arguments: &Arguments, variant: Variant, fold: Option<usize>) -> String {
    let mut words = vec![program(), "study".to_owned()];
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    option("preset", arguments.preset.clone());
    option("study", arguments.study.display().to_string());
    option("protocol", arguments.protocol.to_string());
    if let Some(data) = arguments.data.folder() {
        option("data", data.display().to_string());
    }
    option("variant", variant.to_string());
    if let Some(fold) = fold {
        option("fold", fold.to_string());
    }
    words.extend(shared_options(&arguments.data, arguments.backend));
    line(&words)
}
