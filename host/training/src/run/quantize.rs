//! Step 3: writes the student as a model file.

use std::path::Path;

use burn::tensor::Device;
use serde::{Deserialize, Serialize};
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, ProvenanceParts};
use shared::stream::smoother::AggregationMode;

use super::aggregation::aggregation;
use super::context::RunContext;
use super::error::StepError;
use crate::student::model::Student;
use crate::student::quantization;
use evaluation::LookAhead;
use execution::bounded_read;
use execution::fingerprint::Fingerprint;
use execution::run_folder::write_whole;
use presets::{Preset, distillation};

pub use evaluation::results::MODEL;

/// Name of the file with the [`Figure`]s of the model file in a run folder.
const FIGURES: &str = "figures.json";

/// Score of the model, kept in the model file: data set and metric, and its value.
pub(super) type Figure = (String, f32);

/// Figures of one model file.
#[derive(Serialize, Deserialize)]
struct Figures {
    /// Fingerprint of the model file without figures.
    model: Fingerprint,
    figures: Vec<Figure>,
}

/// Model file that a run evaluates.
pub struct ModelFile {
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    /// Whether [`quantize`] makes this file of the run's student, regardless of figures.
    pub is_own: bool,
}

impl ModelFile {
    /// Reads the model file in the run folder; none in a run without a student.
    pub fn of_run(context: &RunContext) -> Result<Option<Self>, StepError> {
        if !context.has(distillation::NAME) {
            return Ok(None);
        }
        let path = context.folder.file(MODEL);
        let file = Self::read(context, &path)?;
        if file.is_own {
            Ok(Some(file))
        } else {
            Err(StepError::OtherModelFile { path })
        }
    }

    /// Reads any model file.
    pub fn read(context: &RunContext, path: &Path) -> Result<Self, StepError> {
        let bytes = bounded_read::read_model(path).map_err(|source| StepError::NoModelFile {
            path: path.to_owned(),
            source,
        })?;
        let is_own = context.has(distillation::NAME) && {
            let figures = Model::parse(&bytes)?.header.provenance.metrics;
            let figures = figures.iter().map(|(name, value)| (name.to_owned(), value));
            let student = context.student(distillation::NAME)?;
            bytes == model_bytes(context, &student, aggregation(context)?, figures.collect())?
        };
        Ok(Self { bytes, is_own })
    }
}

/// Writes the model file and returns its bytes.
///
/// The aggregation mode is chosen on the validation subjects. The file has the scores of the last evaluation if that was of
/// the same model.
pub fn quantize(context: &RunContext, out: &Path) -> Result<Vec<u8>, StepError> {
    let student = context.student(distillation::NAME)?;
    let aggregation = aggregation(context)?;
    let made_from = context.config.fingerprint();
    let model = model_without_figures(context, &student, aggregation)?;
    let figures = match context.folder.load_stamped::<Figures>(FIGURES, made_from) {
        Ok(kept) if kept.model == model => kept.figures,
        _ => Vec::new(),
    };
    let bytes = model_bytes(context, &student, aggregation, figures)?;
    write_whole(out, &bytes)?;
    Ok(bytes)
}

/// Saves the scores of the run's own model file, for its header.
pub(super) fn save_figures(context: &RunContext, figures: Vec<Figure>) -> Result<(), StepError> {
    let student = context.student(distillation::NAME)?;
    let figures = Figures {
        model: model_without_figures(context, &student, aggregation(context)?)?,
        figures,
    };
    let made_from = context.config.fingerprint();
    Ok(context.folder.save_stamped(FIGURES, made_from, &figures)?)
}

/// Fingerprint of the run's model file without figures, which identifies it.
fn model_without_figures(
    context: &RunContext,
    student: &Student,
    aggregation: LookAhead,
) -> Result<Fingerprint, StepError> {
    let bytes = model_bytes(context, student, aggregation, Vec::new())?;
    Ok(Fingerprint::of_bytes(&bytes))
}

/// Encodes the model file of a student.
pub(super) fn model_bytes(
    context: &RunContext,
    student: &Student,
    aggregation: LookAhead,
    figures: Vec<Figure>,
) -> Result<Vec<u8>, StepError> {
    let preset = &context.config.preset;
    let split = &context.config.split;
    let provenance = ProvenanceParts {
        data_sets: data_sets(&split.training),
        subjects_seen: context.config.subjects_seen(),
        subjects_left_out: [&split.held_out[..], &split.test].concat(),
        git_revision: context.config.git_revision.clone().unwrap_or_default(),
        seed: preset.seed,
        metrics: figures,
    };
    let smoother = preset.smoother_defaults(match aggregation {
        LookAhead::SameInstant => AggregationMode::SameInstant,
        LookAhead::None | LookAhead::AllRows => AggregationMode::AllRowsFrom,
    });
    quantization::quantize(
        student,
        &preset.student,
        preset.vocabulary(),
        (smoother, preset.preprocessing()),
        context.config.alignment_template(),
        provenance,
    )
    .map_err(StepError::Student)
}

/// Data sets that subjects (`data-set/subject`) belong to, each once.
fn data_sets(subjects: &[String]) -> Vec<String> {
    let mut sets: Vec<String> = subjects
        .iter()
        .filter_map(|subject| subject.split('/').next())
        .map(str::to_owned)
        .collect();
    sets.dedup();
    sets
}

/// Refuses a student that cannot become a model file, or that no board can run. A student with random weights is written,
/// read and loaded by the code that will do so with the trained one.
pub(super) fn refuse_impossible(preset: &Preset, device: &Device) -> Result<(), StepError> {
    let (seed, other) = (preset.seed, preset.other());
    let student = Student::new(seed, &preset.student, preset.classes, other, device);
    let smoother = preset.smoother_defaults(AggregationMode::AllRowsFrom);
    let provenance = ProvenanceParts::default();
    let (config, vocabulary) = (&preset.student, preset.vocabulary());
    let bytes = quantization::quantize(
        &student,
        config,
        vocabulary,
        (smoother, preset.preprocessing()),
        None,
        provenance,
    )
    .map_err(StepError::Student)?;
    let model = Model::parse(&bytes).map_err(StepError::Student)?;
    if preset.student.board {
        DeviceEncoder::new(&model).map_err(StepError::Board)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::thread;

    use burn::nn::LinearConfig;

    use super::*;
    use crate::optimization::initial;
    use crate::weights::values;

    #[test]
    fn a_student_that_is_tried_changes_no_weights_of_a_training_beside_it() {
        let preset = Preset::find("cpu").unwrap();
        let device = Device::default();
        let create = || LinearConfig::new(200, 300).init(&device);
        let drawn = || values(&initial(5, &device, create));
        let expected = drawn();
        thread::scope(|scope| {
            let tries = || (0..20).for_each(|_| refuse_impossible(&preset, &device).unwrap());
            let tries = scope.spawn(tries);
            while !tries.is_finished() {
                assert!(drawn() == expected, "other weights of the same seed");
            }
        });
    }
}
