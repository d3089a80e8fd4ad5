//! Choice of the smoother's aggregation mode, once a run, on the validation subjects.

use serde::{Deserialize, Serialize};

use super::candidates::candidate;
use super::context::RunContext;
use super::error::StepError;
use evaluation::{EvaluatedRecording, LookAhead, score};
use execution::fingerprint::Fingerprint;
use presets::Aggregation;
use presets::distillation;
use recordings::split::Role;

/// Name of the file with the chosen mode in a run folder.
const AGGREGATION: &str = "aggregation.json";

/// Content of that file.
#[derive(Serialize, Deserialize)]
struct Chosen {
    aggregation: LookAhead,
}

/// Returns the preset's aggregation mode. Without one, chooses the mode with which the student (or the teacher, in a run without
/// a student) follows more transitions of the validation subjects; all rows on a tie.
pub(super) fn aggregation(context: &RunContext) -> Result<LookAhead, StepError> {
    const NAME: &str = "choosing the aggregation mode";
    let (folder, config) = (&context.folder, &context.config);
    match config.preset.smoother.aggregation {
        Some(Aggregation::AllRows) => return Ok(LookAhead::AllRows),
        Some(Aggregation::SameInstant) => return Ok(LookAhead::SameInstant),
        None => {}
    }
    let (student, teacher) = (distillation::NAME, presets::teacher::NAME);
    let (model, lineage) = if context.has(student) {
        (student, config.student_lineage(student, folder)?)
    } else if context.has(teacher) {
        (teacher, config.teacher_lineage())
    } else {
        return Ok(LookAhead::AllRows);
    };
    let weights = folder.weights_fingerprint(model, lineage)?;
    let made_from = Fingerprint::of(&(config.streams_lineage(), weights));
    // A mode chosen with another model is ignored and chosen again.
    if let Ok(kept) = folder.load_stamped::<Chosen>(AGGREGATION, made_from) {
        return Ok(kept.aggregation);
    }
    let recordings = EvaluatedRecording::of_role(config, &context.library, Role::Validation);
    let candidate = candidate(context, model, NAME.into(), &recordings)?;
    let correct = |look_ahead| -> Result<usize, StepError> {
        let vocabulary = config.preset.vocabulary();
        let scores = score(&candidate, &recordings, vocabulary, look_ahead)?;
        // The last rows are over all data sets, one for each group of people.
        let over_all = scores.last().map(|score| score.data_set.clone());
        let rows = scores
            .iter()
            .filter(|score| Some(&score.data_set) == over_all.as_ref());
        Ok(rows.map(|score| score.widest().correct).sum())
    };
    let chosen = if correct(LookAhead::SameInstant)? > correct(LookAhead::AllRows)? {
        LookAhead::SameInstant
    } else {
        LookAhead::AllRows
    };
    let content = Chosen {
        aggregation: chosen,
    };
    folder.save_stamped(AGGREGATION, made_from, &content)?;
    Ok(chosen)
}
