//! `myointent template`: the alignment template of a model file.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use crate::cli::arguments::{AS_RECORDED, recordings_of};
use crate::cli::output::refuse_existing;
use crate::cli::read_model;
use evaluation::EvaluationError;
use execution::run_folder::write_whole;
use presets::resolve::opens;
use recordings::alignment::{FEWEST_PEOPLE, template};
use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::lags;
use recordings::split::predefined;
use recordings::{Library, Recording};
use shared::model::file::Model;

#[derive(Debug, Args)]
#[command(
    after_help = "The template says what an open hand looks like over the electrodes; the device aligns the armband by it\n\
    (docs/alignment.md). `quantize` writes one of the training people into every model file. This command is for files without\n\
    one, and changes nothing else in them.\n\n\
    Example:\n  myointent template models/three-class.intent --data DIR"
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// Folder of the recordings that the model was trained on.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// File to write; it must not exist.
    ///
    /// The model file itself if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Refuse damaged files instead of leaving them out.
    #[arg(long)]
    strict: bool,
    #[arg(hide_short_help = true, long, help = AS_RECORDED)]
    as_recorded: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    arguments.out.as_deref().map_or(Ok(()), refuse_existing)?;
    let bytes = read_model(path)?;
    let library = recordings_of(&[&arguments.data], arguments.strict, arguments.as_recorded)?;
    let (file, people) = model_with_template(&bytes, &library)?;
    let out = arguments.out.as_ref().unwrap_or(path);
    write_whole(out, &file)?;
    writeln!(
        std::io::stdout(),
        "{}: template of {people} people who open the hand",
        out.display()
    )?;
    Ok(())
}

/// A model file with a template of the people whom the model has seen and of whom a library holds recordings; and the
/// number of these people. Everything else in the file stays as it is.
///
/// Electrodes are in the common frame of all data sets, as in training. A constant label lag of a set is estimated on
/// the training people among those seen.
fn model_with_template(file: &[u8], library: &Library) -> anyhow::Result<(Vec<u8>, usize)> {
    let model = Model::parse(file).map_err(EvaluationError::from)?;
    let seen: Vec<&str> = model.header.provenance.subjects_seen.iter().collect();
    let own: Vec<&Recording> = library
        .recordings
        .iter()
        .filter(|recording| seen.contains(&recording.subject.as_str()))
        .collect();
    let lags = lags(&own, LabelLag::default(), &predefined::is_training);
    let opens = opens(own.iter().copied(), |recording| {
        let lag = &lags[&recording.data_set];
        (recording.samples.clone(), lag.of_recording(recording))
    });
    let template = template(&opens).with_context(|| {
        let found = opens.len();
        format!(
            "{found} of the people whom the model has seen open the hand in these recordings, {FEWEST_PEOPLE} are needed: give the recordings that it was trained on"
        )
    })?;
    let file = Model::with_template(file, Some(&template)).map_err(EvaluationError::from)?;
    Ok((file, opens.len()))
}
