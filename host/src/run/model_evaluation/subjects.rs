//! Whom model files are evaluated on, and who is left out.

use serde::Serialize;
use shared::model::file::Model;

use super::Selection;
use super::named_model::NamedModel;
use crate::dataset::split::{circles, expand};
use crate::dataset::{Recording, folds};
use crate::run::error::StepError;

/// A subject in the results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EvaluatedSubject {
    /// The subject, as `data-set/subject`.
    pub subject: String,
    /// Names of the models that were trained on this person or validated with: their scores are too good.
    pub seen_by: Vec<String>,
    /// Whether it is a test person.
    pub test: bool,
}

/// People who are not evaluated, by reason.
#[derive(Default)]
pub(super) struct LeftOut {
    pub(super) seen: Vec<String>,
    pub(super) test: Vec<String>,
}

/// The people to evaluate, and those who are not.
///
/// # Errors
/// When a name is unknown or nobody is left.
pub(super) fn subjects(
    models: &[NamedModel],
    parsed: &[Model<'_>],
    recordings: &[&Recording],
    selection: &Selection,
) -> Result<(Vec<EvaluatedSubject>, LeftOut), StepError> {
    let known = folds::subjects(recordings.iter().copied());
    let named = expand("--subjects", &selection.subjects, &known)?;
    let mut evaluated = Vec::new();
    let mut left_out = LeftOut::default();
    for &subject in known.values().flatten() {
        let is_named = named.contains(subject);
        if !is_named && !named.is_empty() {
            continue;
        }
        let test = circles::is_test(subject);
        let saw = |model: &Model<'_>| {
            let mut seen = model.header.provenance.subjects_seen.iter();
            seen.any(|seen| seen == subject)
        };
        let seen_by: Vec<String> = models
            .iter()
            .zip(parsed)
            .filter(|(_, parsed)| saw(parsed))
            .map(|(model, _)| model.name.clone())
            .collect();
        if test && !selection.test && !is_named {
            left_out.test.push(subject.to_owned());
        } else if !seen_by.is_empty() && !selection.seen && !is_named {
            left_out.seen.push(subject.to_owned());
        } else {
            evaluated.push(EvaluatedSubject {
                subject: subject.to_owned(),
                seen_by,
                test,
            });
        }
    }
    if evaluated.is_empty() {
        return Err(StepError::NobodyToEvaluate {
            seen: left_out.seen.len(),
            test: left_out.test.len(),
        });
    }
    Ok((evaluated, left_out))
}
