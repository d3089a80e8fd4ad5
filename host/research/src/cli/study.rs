//! `myointent-research study`: every comparison of the paper, job by job.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use crate::baselines::find_preset;
use crate::comparison::job::Study;
use crate::comparison::variant::Variant;
use myointent::cli::arguments::{BackendArguments, DataArguments};
use myointent::dataset::folds::Protocol;
use myointent::execution::interrupt::Interrupt;

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(
    after_help = "Each job is one fold of one variant and stands for itself (but fine-tuning, which needs the variant\n\
    `pretraining`); one that was interrupted goes on where it stopped, one that is done is passed over.\n\n\
    Examples:\n  myointent-research study --data recordings                 # all jobs, one after the other\n  \
    myointent-research study --data recordings --list | sh     # or any scheduler\n  \
    myointent-research study --data recordings --study runs/sizes --variant student-64x2,student-96x3
  myointent-research tables runs/study --out docs/tables                # what came out"
)]
pub struct Arguments {
    /// Built-in preset or a TOML file that the variants vary.
    #[arg(long, default_value = "study")]
    preset: String,
    /// Folder of the study; runs lie in VARIANT/fold-K below it.
    #[arg(long, value_name = "DIR", default_value = "runs/study")]
    study: PathBuf,
    /// How everybody is left out in turn: `loso`, or `4-fold` with any number.
    #[arg(long, default_value = "4-fold")]
    protocol: Protocol,
    /// Variants to run; all of the paper's comparisons if not given. Students of eight sizes, `student-48x2` (width and
    /// layers) to `student-128x3`, run when they are named.
    #[arg(long, value_delimiter = ',')]
    variant: Vec<Variant>,
    /// The one fold to run, from 1 on; all if not given.
    #[arg(long)]
    fold: Option<usize>,
    /// Print the jobs as commands, one a line, and run none.
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
/// When recordings, preset or folders cannot be used.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let (preset, baselines) = find_preset(&arguments.preset)?;
    let library = Arc::new(arguments.data.load(&preset)?);
    let study = Study {
        folder: &arguments.study,
        preset: &preset,
        protocol: arguments.protocol,
        baselines: &baselines,
        library,
        data: arguments.data.data.as_deref(),
        strict: arguments.data.strict,
        device: arguments.backend.device(),
        interrupt: &interrupt,
    };
    let variants = if arguments.variant.is_empty() {
        &Variant::ALL[..]
    } else {
        &arguments.variant
    };
    let mut out = std::io::stdout().lock();
    for &variant in variants {
        let folds = study.folds(variant)?;
        let wanted = |fold: &Option<usize>| arguments.fold.is_none() || *fold == arguments.fold;
        let jobs: Vec<_> = folds
            .iter()
            .copied()
            .filter(|fold| !variant.has_folds() || wanted(fold))
            .collect();
        if jobs.is_empty() {
            anyhow::bail!(
                "{variant} has folds 1 to {}, none of the number asked for",
                folds.len()
            );
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

/// The command of one job, to be run by a shell in this folder.
fn command(arguments: &Arguments, variant: Variant, fold: Option<usize>) -> String {
    let program = std::env::args()
        .next()
        .unwrap_or_else(|| "myointent-research".to_owned());
    let mut words = vec![program, "study".to_owned()];
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    option("preset", arguments.preset.clone());
    option("study", arguments.study.display().to_string());
    option("protocol", arguments.protocol.to_string());
    if let Some(data) = &arguments.data.data {
        option("data", data.display().to_string());
    }
    option("variant", variant.to_string());
    if let Some(fold) = fold {
        option("fold", fold.to_string());
    }
    if arguments.data.strict {
        words.push("--strict".to_owned());
    }
    words
        .iter()
        .map(|word| quoted(word))
        .collect::<Vec<_>>()
        .join(" ")
}

/// A word as a shell reads it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("runs/study-1"), "runs/study-1");
        assert_eq!(quoted("my data"), "'my data'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
