//! `myointent predict`: a model's labels and logits, for other programs.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use shared::intent::Intent;
use shared::model::LookBackLogits;
use shared::model::file::Model;
use shared::units::{PATCH, Sample};

use super::replay::recording_of;
use crate::cli::arguments::{AS_RECORDED, recordings_of};
use crate::cli::output::{file_of, first_line, refuse_unlike};
use crate::cli::read_model;
use evaluation::inference::{input, integer_logits};
use evaluation::{SmoothedLabels, smooth};
use execution::run_folder::write_whole;
use recordings::npy;
use recordings::readers::path::ending;

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
    #[arg(long, value_name = "FILE.intent")]
    model: PathBuf,
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
}

/// Runs a model and writes its labels and logits.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (paths, out) = (&arguments.recording, &arguments.out);
    let is_file = out.extension().is_some() || arguments.name.is_some();
    if is_file {
        // A wrong ending is refused before the work.
        is_array(out)?;
    }
    let path = &arguments.model;
    let bytes = read_model(path)?;
    let model = Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
    if is_file {
        let [path] = &paths[..] else {
            bail!(
                "--out is a file: expected one recording, or a folder as --out for the labels of each"
            );
        };
        let recording = recording_of(path, arguments.name.as_deref(), arguments.as_recorded)?;
        return write(&over_recording(&model, &recording.samples)?, out);
    }
    for recording in recordings_of(paths, false, arguments.as_recorded)?.recordings {
        let file = file_of(&recording, out, "csv")?;
        std::fs::create_dir_all(file.parent().unwrap_or(out))
            .with_context(|| file.display().to_string())?;
        write(&over_recording(&model, &recording.samples)?, &file)?;
    }
    Ok(())
}

/// Writes a table, which replaces no file of another kind.
fn write(matrix: &Matrix, out: &Path) -> anyhow::Result<()> {
    let bytes = matrix.encode(is_array(out)?);
    refuse_unlike(out, first_line(&bytes))?;
    Ok(write_whole(out, &bytes)?)
}

fn over_recording(model: &Model<'_>, samples: &[Sample]) -> anyhow::Result<Matrix> {
    let rows = integer_logits(model, &input(samples, model.header.preprocessing))?;
    let classes = model.header.dimensions.vocabulary.classes();
    let settings = model.header.smoother.in_patches();
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

/// Returns true if a file is written as a binary array (f32, without column names) in place of CSV, by its ending.
fn is_array(path: &Path) -> anyhow::Result<bool> {
    match ending(path).as_deref() {
        Some("npy") => Ok(true),
        Some("csv") => Ok(false),
        _ => bail!(
            "{}: expected a name that ends in .npy or .csv",
            path.display()
        ),
    }
}

/// Rows of numbers, with the names of their columns.
struct Matrix {
    /// Column names: at least one, without commas.
    columns: Vec<String>,
    /// Values row by row; the length is a multiple of the number of columns.
    values: Vec<f32>,
}

impl Matrix {
    /// Encodes the matrix as a binary array, or as CSV with the column names in the first row.
    fn encode(&self, is_array: bool) -> Vec<u8> {
        let rows = self.values.chunks_exact(self.columns.len());
        if is_array {
            let shape = [rows.len(), self.columns.len()];
            let data: Vec<u8> = self.values.iter().flat_map(|v| v.to_le_bytes()).collect();
            return npy::encode("<f4", &shape, &data);
        }
        let mut text = self.columns.join(",") + "\n";
        for row in rows {
            let cells: Vec<_> = row.iter().map(f32::to_string).collect();
            text += &(cells.join(",") + "\n");
        }
        text.into_bytes()
    }
}

#[cfg(test)]
mod tests {
    use recordings::npy::Values;
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

    #[test]
    fn both_formats_hold_every_value() {
        let matrix = Matrix {
            columns: vec!["label".into(), "logit_relax".into()],
            values: vec![-1.0, 0.25, 2.0, f32::NAN],
        };
        let text = String::from_utf8(matrix.encode(false)).unwrap();
        assert_eq!(text, "label,logit_relax\n-1,0.25\n2,NaN\n");
        let array = npy::parse(&matrix.encode(true)).unwrap();
        assert_eq!(
            (&array.shape[..], array.descr.as_str()),
            (&[2, 2][..], "<f4")
        );
        let Values::Numbers(values) = array.values else {
            panic!("{array:?}");
        };
        assert_eq!(values[..3], [-1.0, 0.25, 2.0]);
        assert!(values[3].is_nan());
    }

    #[test]
    fn another_ending_is_refused() {
        assert!(is_array(Path::new("labels.txt")).is_err());
        assert!(is_array(Path::new("npy")).is_err());
    }
}
