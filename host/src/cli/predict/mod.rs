//! `myointent predict`: a model's labels and logits, for other programs.

mod matrix;

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
#[cfg(feature = "train")]
use clap::ValueEnum;
use shared::intent::Intent;
use shared::model::LookBackLogits;
use shared::model::file::Model;
use shared::stream::smoother::Settings;
use shared::units::{PATCH, Sample};

use self::matrix::Format;
use self::matrix::Matrix;
use super::replay::recording_of;
use crate::cli::arguments::{AS_RECORDED, recordings_of};
use crate::cli::output::{file_of, first_line, refuse_unlike};
use crate::cli::read_model;
use evaluation::inference::{input, integer_logits};
use evaluation::{SmoothedLabels, smooth};
use execution::run_folder::write_whole;
#[cfg(feature = "train")]
use training::backend::BackendArguments;

/// A checkpoint of a run folder.
#[cfg(feature = "train")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Which {
    /// The masked transformer.
    Teacher,
    /// The float student.
    Student,
}

/// Arguments of `predict`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  myointent predict --model models/three-class.intent --recording FILE.csv --out labels.csv",
    after_long_help = "One row a sample with `label`, the class number of the smoothed label at its reference\n\
    time (-1 before the first label and after the last one), `emitted`, that of the label that has been emitted, and the logits of the sample's patch when it was the newest\n\
    (NaN for the last samples, where they are fewer than a patch of 10). The last samples have no label: it would need the\n\
    samples of the look-ahead after them. `score` does not count them.\n\n\
    Examples:\n  myointent predict --model models/three-class.intent --recording recordings/s1/s1_grasp.csv --out labels.csv\n  \
    myointent predict --model models/three-class.intent --recording RECORDINGS --out LABELS"
)]
pub struct Arguments {
    /// Model file.
    #[arg(
        long,
        value_name = "FILE.intent",
        conflicts_with = "run",
        required_unless_present = "run"
    )]
    model: Option<PathBuf>,
    /// Run folder with a checkpoint.
    #[arg(long, value_name = "DIR")]
    pub(super) run: Option<PathBuf>,
    /// Checkpoint of the run folder.
    #[cfg(feature = "train")]
    #[arg(long, value_enum, default_value = "student")]
    pub(super) which: Which,
    /// A recording, in any format that `myointent data inspect` reads; several, or folders of them, if --out is a folder.
    #[arg(long, value_name = "PATH", num_args = 1.., required = true)]
    recording: Vec<PathBuf>,
    /// Recording to label, if the path holds several, as `data inspect` prints it: data-set/person/name.
    #[arg(long)]
    name: Option<String>,
    #[arg(hide_short_help = true, long, help = AS_RECORDED)]
    as_recorded: bool,
    /// File to write: .npy (f32) or .csv; or for all recordings a folder, without such an ending, in which each has the
    /// file data-set/person/name.csv, for `score`.
    ///
    /// Earlier predictions of the same columns are replaced, no other file.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[cfg(feature = "train")]
    #[command(flatten)]
    pub(super) backend: BackendArguments,
}

/// Runs a model and writes its labels and logits.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let paths = &arguments.recording;
    if arguments.out.extension().is_some() || arguments.name.is_some() {
        // A wrong ending is refused before the work.
        Format::of(&arguments.out)?;
        let [path] = &paths[..] else {
            bail!(
                "--out is a file: expected one recording, or a folder as --out for the labels of each"
            );
        };
        let recording = recording_of(path, arguments.name.as_deref(), arguments.as_recorded)?;
        return write(
            &over_recording(&loaded(arguments)?, &recording.samples)?,
            &arguments.out,
        );
    }
    let library = recordings_of(paths, false, arguments.as_recorded)?;
    let model = loaded(arguments)?;
    for recording in library.recordings {
        let out = file_of(&recording, &arguments.out, "csv")?;
        std::fs::create_dir_all(out.parent().unwrap_or(&arguments.out))
            .with_context(|| out.display().to_string())?;
        write(&over_recording(&model, &recording.samples)?, &out)?;
    }
    Ok(())
}

/// Writes a table, which replaces no file of another kind.
fn write(matrix: &Matrix, out: &Path) -> anyhow::Result<()> {
    let bytes = matrix.encode(Format::of(out)?);
    refuse_unlike(out, first_line(&bytes))?;
    Ok(write_whole(out, &bytes)?)
}

/// Logits of every patch, number of classes, and the smoother's settings.
pub(super) type Logits = (Vec<LookBackLogits>, usize, Settings);
/// Function of a model that was read: computes the logits of samples.
pub(super) type Loaded<'a> = Box<dyn Fn(&[Sample]) -> anyhow::Result<Logits> + 'a>;

/// Reads the model of the arguments.
fn loaded(arguments: &Arguments) -> anyhow::Result<Loaded<'_>> {
    if let Some(path) = &arguments.model {
        let bytes = read_model(path)?;
        return Ok(Box::new(move |samples| {
            let model =
                Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
            Ok((
                integer_logits(&model, &input(samples, model.header.preprocessing))?,
                model.header.dimensions.vocabulary.classes(),
                model.header.smoother.in_patches(),
            ))
        }));
    }
    #[cfg(feature = "train")]
    return super::steps::predict::loaded(arguments);
    #[cfg(not(feature = "train"))]
    bail!("give --model FILE; {}", super::WITHOUT_TRAINING);
}

fn over_recording(model: &Loaded<'_>, samples: &[Sample]) -> anyhow::Result<Matrix> {
    let (rows, classes, settings) = model(samples)?;
    let labels = smooth(&rows, samples.len(), classes, settings)?;
    Ok(of_samples(&labels, &rows, classes))
}

/// Table of the smoothed labels of every sample and the logits of its patch; NaN where the recording ends within the patch.
fn of_samples(labels: &SmoothedLabels, rows: &[LookBackLogits], classes: usize) -> Matrix {
    let mut values = Vec::with_capacity(labels.reference.len() * (classes + 2));
    let both = labels.reference.iter().zip(&labels.emitted);
    for (sample, (reference, emitted)) in both.enumerate() {
        let number = |label: &Option<Intent>| label.map_or(-1.0, |intent| intent.class() as f32);
        values.extend([reference, emitted].map(number));
        match rows.get(sample / PATCH) {
            Some([newest, ..]) => values.extend(&newest[..classes]),
            None => values.extend(std::iter::repeat_n(f32::NAN, classes)),
        }
    }
    let columns = ["label".to_owned(), "emitted".to_owned()]
        .into_iter()
        .chain(
            Intent::ALL[..classes]
                .iter()
                .map(|intent| format!("logit_{}", intent.name())),
        )
        .collect();
    Matrix { columns, values }
}

#[cfg(test)]
mod tests {
    use shared::intent::MAX_LOGITS;
    use shared::units::LOOK_BACK;

    use super::*;

    #[test]
    fn every_sample_has_a_row_and_a_partial_last_patch_no_logits() {
        let rows = vec![[[0.5; MAX_LOGITS]; LOOK_BACK]; 2];
        let mut labels = SmoothedLabels {
            reference: vec![None; 2 * PATCH + 3],
            emitted: vec![None; 2 * PATCH + 3],
        };
        labels.emitted[2 * PATCH..].fill(Some(Intent::Close));
        let matrix = of_samples(&labels, &rows, 3);
        let rows: Vec<_> = matrix.values.chunks(matrix.columns.len()).collect();
        assert_eq!(rows.len(), labels.reference.len());
        assert_eq!(rows[2 * PATCH - 1], [-1.0, -1.0, 0.5, 0.5, 0.5]);
        for row in &rows[2 * PATCH..] {
            assert_eq!(row[..2], [-1.0, 2.0]);
            assert!(row[2..].iter().all(|logit| logit.is_nan()));
        }
    }
}
