//! Step 3: the student as a model file.

use std::path::Path;

use serde::{Deserialize, Serialize};
use shared::model::file::{ProvenanceParts, SmootherDefaults};
use shared::stream::smoother::AggregationMode;
use shared::units::{HOLD, LOOK_AHEAD};

use super::aggregation::aggregation;
use super::context::RunContext;
use super::error::StepError;
use crate::evaluation::LookAhead;
use crate::execution::run_folder::write_whole;
use crate::student::distillation;
use crate::student::model::Student;
use crate::student::quantization;

/// Name of the model file in a run folder.
pub const MODEL: &str = "student.intent";
/// Name of the file that keeps the [`Figure`]s of the model file in a run folder.
pub(super) const FIGURES: &str = "figures.json";

/// A score of the model, kept in the model file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Figure {
    /// Data set and metric.
    pub name: String,
    /// Its value.
    pub value: f32,
}

/// Writes the model file and returns its bytes.
///
/// Its aggregation mode is chosen on the validation subjects.
///
/// # Errors
/// When the student is missing or the model format does not allow its dimensions.
pub fn quantize(context: &RunContext, out: &Path) -> Result<Vec<u8>, StepError> {
    let student = context.student(distillation::NAME)?;
    let bytes = model_bytes(context, &student, aggregation(context)?)?;
    write_whole(out, &bytes)?;
    Ok(bytes)
}

/// Bytes of the model file of a student.
pub(super) fn model_bytes(
    context: &RunContext,
    student: &Student,
    aggregation: LookAhead,
) -> Result<Vec<u8>, StepError> {
    let preset = &context.config.preset;
    let split = &context.config.split;
    let figures: Vec<Figure> = if context.folder.file(FIGURES).exists() {
        context.folder.load_json(FIGURES)?
    } else {
        Vec::new()
    };
    let provenance = ProvenanceParts {
        data_sets: data_sets(&split.training),
        subjects_seen: context.config.subjects_seen(),
        subjects_left_out: [&split.held_out[..], &split.test].concat(),
        git_revision: context.config.git_revision.clone().unwrap_or_default(),
        seed: preset.seed,
        metrics: figures
            .into_iter()
            .map(|figure| (figure.name, figure.value))
            .collect(),
    };
    let smoother = SmootherDefaults {
        aggregation: match aggregation {
            LookAhead::SameInstant => AggregationMode::SameInstant,
            LookAhead::None | LookAhead::AllRows => AggregationMode::AllRowsFrom,
        },
        look_ahead: LOOK_AHEAD,
        hold: HOLD,
    };
    quantization::quantize(
        student,
        &preset.student,
        preset.vocabulary(),
        smoother,
        provenance,
    )
    .map_err(StepError::Student)
}

/// The data sets that subjects (`data-set/subject`) belong to, each once.
fn data_sets(subjects: &[String]) -> Vec<String> {
    let mut sets: Vec<String> = subjects
        .iter()
        .filter_map(|subject| subject.split('/').next())
        .map(str::to_owned)
        .collect();
    sets.dedup();
    sets
}
