//! People whom model files are evaluated on, and people who are left out.

use serde::Serialize;
use shared::model::file::Model;

use super::Selection;
use super::named_model::NamedModel;
use crate::EvaluationError;
use recordings::split::{expand, predefined};
use recordings::{Recording, folds};

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

#[derive(Default)]
pub(super) struct LeftOut {
    pub(super) seen: Vec<String>,
    pub(super) test: Vec<String>,
}

pub(super) fn subjects(
    models: &[NamedModel],
    parsed: &[Model<'_>],
    recordings: &[&Recording],
    selection: &Selection,
) -> Result<(Vec<EvaluatedSubject>, LeftOut), EvaluationError> {
    let known = folds::subjects(recordings.iter().copied());
    let named = expand("--subjects", &selection.subjects, &known, |_| true)?;
    let mut evaluated = Vec::new();
    let mut left_out = LeftOut::default();
    for &subject in known.values().flatten() {
        let is_named = named.contains(subject);
        if !is_named && !named.is_empty() {
            continue;
        }
        let test = predefined::is_test(subject);
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
        // The name of a whole data set does not include its test people.
        let by_name = selection.subjects.iter().any(|name| name == subject);
        if test && !selection.test && !by_name {
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
        return Err(EvaluationError::NobodyToEvaluate {
            seen: left_out.seen.len(),
            test: left_out.test.len(),
        });
    }
    Ok((evaluated, left_out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::DataSet;

    /// Evaluated people of a selection, and test people left out: roshambo/03, and roshambo/06, who is a test person.
    fn selected(names: &[&str], test: bool) -> [Vec<String>; 2] {
        let recordings = ["roshambo/03", "roshambo/06"].map(|subject| {
            Recording::new(DataSet::named("roshambo"), subject, Vec::new(), Vec::new())
        });
        let selection = Selection {
            subjects: names.iter().map(|&name| name.to_owned()).collect(),
            test,
            ..Selection::default()
        };
        let recordings: Vec<&Recording> = recordings.iter().collect();
        let (evaluated, left_out) = subjects(&[], &[], &recordings, &selection).unwrap();
        let evaluated = evaluated.into_iter().map(|own| own.subject);
        [evaluated.collect(), left_out.test]
    }

    #[test]
    fn test_people_of_a_whole_set_are_evaluated_if_asked_for_and_left_out_in_words_if_not() {
        let [plain, test] = ["roshambo/03", "roshambo/06"];
        for names in [&[][..], &["roshambo"], &["roshambo", plain]] {
            assert_eq!(
                selected(names, true),
                [&[plain, test][..], &[]],
                "{names:?}"
            );
            assert_eq!(selected(names, false), [[plain], [test]], "{names:?}");
        }
        // A person who is named is evaluated.
        assert_eq!(selected(&[test], false), [&[test][..], &[]]);
        assert_eq!(selected(&[plain], true), [&[plain][..], &[]]);
    }
}
