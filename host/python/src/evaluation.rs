//! Evaluation of a model file on any recordings.

use std::path::PathBuf;

use evaluation::model_evaluation::{Selection, evaluate_models};
use evaluation::report::{labels, model_report, text};
use pyo3::prelude::*;
use recordings::labels::lag::LabelLag;

use crate::failure::told;
use crate::model::Model;
use crate::recording::library;
use crate::report::Report;

/// Evaluates a model on the recordings at or below a path, as `myointent evaluate --data` does; floors beside it.
///
/// Args:
///     model: The model.
///     path: Folder, file or description, as `read` takes it.
///     people: People (`data-set/person`) and whole data sets; everybody if empty.
///     seen: Also people whom the model was trained on or validated with.
///     test_people: Also test people, who are for releases.
///     strict: Refuse damaged files instead of leaving them out.
///     label_lag: How labels, which are cues, are moved to where the muscle acts: "each-cue", "estimated" or "none".
///     as_recorded: Leave the channels of published sets in their own order instead of turning them into the frame of the
///         models.
///     report: Page (HTML) to write; an earlier file is replaced.
#[pyfunction]
#[pyo3(signature = (model, path, *, people = Vec::new(), seen = false, test_people = false, strict = false, label_lag = "each-cue", as_recorded = false, report = None))]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn evaluate(
    py: Python<'_>,
    model: &Model,
    path: PathBuf,
    people: Vec<String>,
    seen: bool,
    test_people: bool,
    strict: bool,
    label_lag: &str,
    as_recorded: bool,
    report: Option<PathBuf>,
) -> PyResult<Report> {
    let selection = Selection {
        subjects: people,
        seen,
        test: test_people,
        label_lag: label_lag.parse::<LabelLag>().map_err(told)?,
        ..Selection::default()
    };
    let library = library(py, &path, strict, as_recorded)?;
    let models = std::slice::from_ref(&*model.named);
    let evaluation = py
        .detach(|| {
            let evaluation = evaluate_models(models, &library, &selection)?;
            if let Some(page) = report {
                model_report::write(&evaluation, &path.display().to_string(), &page)?;
            }
            Ok(evaluation)
        })
        .map_err(|error: evaluation::EvaluationError| told(error))?;
    let results = &evaluation.results;
    let facts = labels(&results.lags, &results.gestures);
    let text = text(&model_report::tables(results, false), &facts);
    Report::of(py, results, text)
}
