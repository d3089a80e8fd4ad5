//! `myointent evaluate`: a run's models on its held-out subjects, or model files on any recordings.

use std::path::PathBuf;

use clap::Args;
#[cfg(feature = "train")]
use training::backend::BackendArguments;

use crate::cli::evaluate_models;
use crate::cli::output::Width;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent evaluate --run runs/mine\n  myointent evaluate --model models/three-class.intent --data DIR",
    after_long_help = "balanced: mean recall of the classes present. TA: transition accuracy, share of label changes that are followed within\n\
    half a second either way and held. recognised: share of gestures whose label is emitted and held, and no other.\n\
    decided: share of gestures whose most frequent emitted label is right, balanced over labels. rest kept: rest spans that stay at rest.\n\
    latency: median / 90th percentile from muscle onset to the emitted label, look-ahead included, misses counted as\n\
    misses. release, off: the same from the muscle's end to the change away from the gesture, if recognised. false/min: false activations a minute of rest. flicker/min: label changes a minute beyond the true\n\
    ones. raw: share of samples. [a, b]: 95 % interval of the mean, from six subjects on. n: subjects of a number, where its\n\
    row has more. classes: subjects with all classes of the model in their recordings, and subjects with fewer, in rows of\n\
    their own. Floors: a constant `relax`, and an\n\
    energy detector fitted to the training subjects. docs/metrics.md has the definitions; results.json in the run folder\n\
    has all numbers, with every aggregation mode and every subject.\n\n\
    Examples:\n  myointent evaluate --run runs/mine\n  \
    myointent evaluate --model models/three-class.intent --data DIR\n  \
    myointent evaluate --model a.intent --model b.intent --data DIR --subjects roshambo,ss-stm/sub3 --csv people.csv\n  \
    myointent evaluate --model a.intent --data DIR --rotate any --align"
)]
pub struct Arguments {
    /// Run folder of `myointent quantize`.
    #[cfg(feature = "train")]
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    pub(super) run: PathBuf,
    /// Model file to evaluate; the run folder's if not given.
    ///
    /// The results of another model are printed and not kept. With --data several may be given.
    #[arg(long, value_name = "FILE")]
    pub(super) model: Vec<PathBuf>,
    #[command(flatten)]
    models: evaluate_models::Options,
    /// Print JSON instead of tables.
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) width: Width,
    #[cfg(feature = "train")]
    #[command(flatten)]
    pub(super) backend: BackendArguments,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if !arguments.models.data.is_empty() {
        let width = (!arguments.json).then_some(&arguments.width);
        return evaluate_models::run(&arguments.model, &arguments.models, width);
    }
    #[cfg(feature = "train")]
    return super::steps::evaluate::run(arguments);
    #[cfg(not(feature = "train"))]
    anyhow::bail!("give --data DIR; {}", super::WITHOUT_TRAINING);
}
