//! Step 4: evaluation of every model of the run on the held-out subjects.

use shared::model::file::Model;

use super::aggregation::aggregation;
use super::candidates::candidate;
use super::context::RunContext;
use super::error::StepError;
use super::quantize::{Figure, ModelFile, save_figures};
use evaluation::integer_candidate;
use evaluation::{
    Candidate, EnergyDetector, EvaluatedRecording, Group, Measure, System, Truth, constant, cued,
    score_all,
};
use execution::progress;
use execution::run_folder::RunError;
use presets::config::ResolvedConfig;
use presets::distillation;
use recordings::Library;
use recordings::split::Role;

pub use evaluation::results::{Evaluation, RESULTS, Results};

/// Evaluates the run's available models on the held-out subjects: teacher, float student, the integer student of
/// the model file `model`; then the floors.
///
/// The results are kept in the run folder, unless the model file is not the run's.
pub fn evaluate(
    context: &RunContext,
    model: Option<&ModelFile>,
) -> Result<(Results, Evaluation), StepError> {
    let recordings = held_out(context)?;
    let aggregation = aggregation(context)?;
    let is_kept = model.is_none_or(|model| model.is_own);
    let bytes = model.map(|model| model.bytes.as_slice());
    let mut published = candidates(context, &recordings, bytes)?;
    if published.is_empty() {
        return Err(StepError::NoModel);
    }
    let detector = energy_detector(&context.config, &context.library);
    published.push(constant(&recordings));
    published.extend(detector.map(|detector| detector.candidate(&recordings)));
    let vocabulary = context.config.preset.vocabulary();
    let results = Results {
        held_out: context.config.split.held_out.clone(),
        aggregation,
        gestures: cued(&recordings),
        published: score_all(
            &published,
            &recordings,
            vocabulary,
            &[Truth::Published, Truth::LagCompensated],
        )?,
    };
    if is_kept {
        let made_from = context.config.fingerprint();
        context.folder.save_stamped(RESULTS, made_from, &results)?;
        if model.is_some() {
            save_figures(context, figures(&results))?;
        }
    }
    Ok((
        results,
        Evaluation {
            recordings,
            candidates: published,
            is_kept,
        },
    ))
}

/// Loads the results that an earlier [`evaluate`] kept in the run folder, and computes the logits of the run's model file
/// again, but not those of the other models.
pub fn kept(context: &RunContext) -> Result<(Results, Evaluation), StepError> {
    let made_from = context.config.fingerprint();
    let results: Results = context.folder.load_stamped(RESULTS, made_from)?;
    let model = ModelFile::of_run(context)?.ok_or(StepError::NoModel)?;
    let recordings = held_out(context)?;
    let candidate = integer_candidate(System::Integer, &Model::parse(&model.bytes)?, &recordings)?;
    let evaluation = Evaluation {
        recordings,
        candidates: vec![candidate],
        is_kept: true,
    };
    Ok((results, evaluation))
}

/// Recordings of the people whom a run holds out.
fn held_out(context: &RunContext) -> Result<Vec<EvaluatedRecording>, StepError> {
    let recordings = EvaluatedRecording::of_role(&context.config, &context.library, Role::HeldOut);
    if recordings.is_empty() {
        return Err(StepError::NoRecordings);
    }
    Ok(recordings)
}

/// Fits the energy detector to the training people of a run; none if they have no gesture.
pub fn energy_detector(config: &ResolvedConfig, library: &Library) -> Option<EnergyDetector> {
    let detector = EnergyDetector::fit(&EvaluatedRecording::of_role(
        config,
        library,
        Role::Training,
    ))?;
    progress::log(&format!(
        "energy detector: {} from {:.1} counts on",
        detector.active.name(),
        detector.threshold
    ));
    Some(detector)
}

fn candidates(
    context: &RunContext,
    recordings: &[EvaluatedRecording],
    model: Option<&[u8]>,
) -> Result<Vec<Candidate>, StepError> {
    let mut candidates = Vec::new();
    let (teacher, student) = (presets::teacher::NAME, distillation::NAME);
    if context.has(teacher) {
        let own = candidate(context, teacher, System::Teacher, recordings);
        candidates.extend(if_own(own)?);
    }
    if context.has(student) {
        candidates.push(candidate(context, student, System::Student, recordings)?);
    }
    if let Some(bytes) = model {
        let model = Model::parse(bytes)?;
        candidates.push(integer_candidate(System::Integer, &model, recordings)?);
    }
    Ok(candidates)
}

/// Makes a model optional; none, with a line in the log, if it is left over from another run.
fn if_own<T>(model: Result<T, RunError>) -> Result<Option<T>, RunError> {
    match model {
        Ok(model) => Ok(Some(model)),
        Err(error @ RunError::NotOfThisRun { .. }) => {
            progress::log(&format!("left out: {error}"));
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

/// Scores of the integer student for the header of the model file.
fn figures(results: &Results) -> Vec<Figure> {
    let mut figures = Vec::new();
    let chosen = results.published.iter().filter(|score| {
        score.model == System::Integer
            && score.look_ahead == results.aggregation
            && score.truth == Truth::LagCompensated
    });
    let measures = [
        ("balanced accuracy", Measure::BalancedAccuracy),
        ("transition accuracy", Measure::TransitionAccuracy),
        ("gestures recognised", Measure::Recognition),
        ("raw accuracy", Measure::RawAccuracy),
    ];
    for score in chosen {
        let people = match score.people {
            Group::AllClasses => "",
            Group::FewerClasses => ", fewer classes:",
        };
        for (what, measure) in measures {
            if let Some(value) = measure.mean(score) {
                #[expect(clippy::cast_possible_truncation, reason = "a share of 1")]
                figures.push((
                    format!("{}{people} {what}, n {}", score.data_set, value.n),
                    value.mean as f32,
                ));
            }
        }
    }
    figures
}
