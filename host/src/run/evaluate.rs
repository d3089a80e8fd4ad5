//! Step 4: every model of the run, judged on the held-out subjects.

use serde::{Deserialize, Serialize};

use super::aggregation::aggregation;
use super::candidates::{integer_candidate, student_candidate, teacher_candidate};
use super::context::RunContext;
use super::error::StepError;
use super::quantize::{FIGURES, Figure, model_file};
use super::trials;
use crate::evaluation::judge::{Candidate, LookAhead, Score, Truth, judge};
use crate::evaluation::trial::Trial;
use crate::student::distillation;
use crate::teacher;

/// The teacher's name in tables.
pub const TEACHER: &str = "teacher";
/// The name of the student in floating point.
pub const STUDENT: &str = "float student";
/// The name of the student that devices run.
pub const INTEGER: &str = "integer student";
/// The name of a student trained on the labels alone.
pub const LABELS_ONLY: &str = "student without teacher";
/// The same in integers.
pub const INTEGER_LABELS_ONLY: &str = "integer student without teacher";

/// Name of [`Results`] in a run folder.
pub const RESULTS: &str = "results.json";

/// Scores of several models, as `results.json` keeps them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Data sets and subjects that were judged; no model has seen them.
    pub held_out: Vec<String>,
    /// The aggregation that the model file asks for.
    pub aggregation: LookAhead,
    /// Recordings as published.
    pub published: Vec<Score>,
    /// The same people's recordings in random order and rhythm.
    pub spliced: Vec<Score>,
}

/// What the report draws from: the trials and every model's logits over them.
pub struct Judged {
    /// The recordings.
    pub trials: Vec<Trial>,
    /// Every model of the run.
    pub candidates: Vec<Candidate>,
    /// The aggregation that the model file asks for.
    pub aggregation: LookAhead,
}

/// Models that are judged beside the run's own: their logits over trials.
pub type MoreCandidates<'a> = &'a dyn Fn(&[Trial]) -> Result<Vec<Candidate>, StepError>;

/// No further models.
///
/// # Errors
/// Never.
pub fn no_more(_: &[Trial]) -> Result<Vec<Candidate>, StepError> {
    Ok(Vec::new())
}

/// Judges whatever the run has trained on the held-out subjects: the teacher, then `more`, then float
/// student and, of a model file, integer student.
///
/// # Errors
/// When there is no model or nobody to judge, or a model is damaged.
pub fn evaluate(
    context: &RunContext,
    model: Option<&[u8]>,
    more: MoreCandidates<'_>,
) -> Result<(Results, Judged), StepError> {
    let trials = trials::published(&context.config, &context.library);
    let spliced = trials::spliced(&context.config, &context.library);
    if trials.is_empty() {
        return Err(StepError::NothingToJudge);
    }
    let aggregation = aggregation(context)?;
    let published = candidates(context, &trials, model, more)?;
    if published.is_empty() {
        return Err(StepError::NoModel);
    }
    let in_random_order = candidates(context, &spliced, model, more)?;
    let results = Results {
        held_out: context.config.split.held_out.clone(),
        aggregation,
        published: judge_all(
            context,
            &published,
            &trials,
            &[Truth::Published, Truth::LagCompensated],
        )?,
        spliced: judge_all(
            context,
            &in_random_order,
            &spliced,
            &[Truth::LagCompensated],
        )?,
    };
    context.folder.save_json(RESULTS, &results)?;
    context.folder.save_json(FIGURES, &figures(&results))?;
    Ok((
        results,
        Judged {
            trials,
            candidates: published,
            aggregation,
        },
    ))
}

fn judge_all(
    context: &RunContext,
    candidates: &[Candidate],
    trials: &[Trial],
    truths: &[Truth],
) -> Result<Vec<Score>, StepError> {
    let vocabulary = context.config.preset.vocabulary();
    let mut scores = Vec::new();
    if trials.is_empty() {
        return Ok(scores);
    }
    for &truth in truths {
        for candidate in candidates {
            for look_ahead in candidate.conditions() {
                scores.extend(judge(candidate, trials, vocabulary, look_ahead, truth)?);
            }
        }
    }
    Ok(scores)
}

fn candidates(
    context: &RunContext,
    trials: &[Trial],
    model: Option<&[u8]>,
    more: MoreCandidates<'_>,
) -> Result<Vec<Candidate>, StepError> {
    let mut candidates = Vec::new();
    if context.has(teacher::training::NAME) {
        candidates.push(teacher_candidate(context, TEACHER, trials)?);
    }
    candidates.extend(more(trials)?);
    if context.has(distillation::NAME) {
        let student = context.student(distillation::NAME)?;
        candidates.push(student_candidate(context, STUDENT, &student, trials)?);
    }
    if let Some(bytes) = model {
        candidates.push(integer_candidate(INTEGER, bytes, trials)?);
    }
    if context.has(distillation::LABELS_ONLY) {
        let student = context.student(distillation::LABELS_ONLY)?;
        candidates.push(student_candidate(context, LABELS_ONLY, &student, trials)?);
        let bytes = model_file(context, &student, LookAhead::AllRows)?;
        candidates.push(integer_candidate(INTEGER_LABELS_ONLY, &bytes, trials)?);
    }
    Ok(candidates)
}

/// What a model file says about the integer student's accuracy.
fn figures(results: &Results) -> Vec<Figure> {
    let mut figures = Vec::new();
    let chosen = results.published.iter().filter(|score| {
        score.model == INTEGER
            && score.look_ahead == results.aggregation
            && score.truth == Truth::LagCompensated
    });
    for score in chosen {
        let widest = score.widest();
        let mut keep = |what: &str, mean: Option<f64>| {
            if let Some(value) = mean {
                #[expect(clippy::cast_possible_truncation, reason = "an accuracy")]
                figures.push(Figure {
                    name: format!("{} {what}", score.data_set),
                    value: value as f32,
                });
            }
        };
        keep("raw accuracy", widest.raw_accuracy.map(|raw| raw.mean));
        keep(
            "transition accuracy",
            widest.transition_accuracy.map(|transition| transition.mean),
        );
    }
    figures
}
