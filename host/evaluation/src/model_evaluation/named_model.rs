//! A model file with its name in tables.

use std::collections::BTreeSet;
use std::path::Path;

use shared::intent::Vocabulary;
use shared::model::file::Model;

use crate::results::MODEL;
use crate::{Candidate, EvaluatedRecording, EvaluationError, System, integer_candidate};
use execution::bounded_read;

/// A model file under evaluation, with its name in tables.
#[derive(Clone, Debug)]
pub struct NamedModel {
    /// Name in tables.
    pub name: String,
    /// The file's content.
    pub bytes: Vec<u8>,
}

impl NamedModel {
    /// A model of a name in tables. A name that [another row may have](is_taken) gets the ending of model files.
    pub fn new(name: &str, bytes: Vec<u8>) -> Self {
        let ending = if is_taken(name) { ".intent" } else { "" };
        Self {
            name: format!("{name}{ending}"),
            bytes,
        }
    }

    /// Reads a model file; its name is the file's without the extension, and that of a run folder's model the folder's.
    pub fn read(path: &Path) -> std::io::Result<Self> {
        let bytes = bounded_read::read_model(path)?;
        let folder = path.parent().and_then(Path::file_name);
        let stem = path.file_stem().unwrap_or(path.as_os_str());
        let name = match folder {
            Some(folder) if path.file_name().is_some_and(|file| file == MODEL) => folder,
            _ => stem,
        };
        Ok(Self::new(&name.to_string_lossy(), bytes))
    }
}

/// Whether other rows than a model file's may have a name: rows of other [systems](System), and of models that have seen
/// people.
pub fn is_taken(name: &str) -> bool {
    !matches!(System::from(name), System::Model(_)) || name.contains(SEEN)
}

/// Refuses models whose rows could not be told apart.
pub(super) fn distinct(models: &[NamedModel]) -> Result<(), EvaluationError> {
    let mut names = BTreeSet::new();
    let same = models
        .iter()
        .find(|model| is_taken(&model.name) || !names.insert(&model.name));
    match same {
        None => Ok(()),
        Some(model) => Err(EvaluationError::SameName(model.name.clone())),
    }
}

/// Text behind the name of a model that has seen people: ` (has seen 2 of 5)`.
pub const SEEN: &str = " (has seen ";

/// A model's logits over recordings that another run evaluates.
///
/// # Errors
/// When the model is refused, or has seen a person of the recordings.
pub fn beside(
    model: &NamedModel,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, EvaluationError> {
    let parsed = Model::parse(&model.bytes)?;
    let seen: Vec<&str> = parsed.header.provenance.subjects_seen.iter().collect();
    let mut evaluated = recordings.iter().map(|own| own.subject.as_str());
    match evaluated.find(|subject| seen.contains(subject)) {
        None => integer_candidate(&model.name[..], &parsed, recordings),
        Some(subject) => Err(EvaluationError::Seen {
            model: model.name.clone(),
            subject: subject.to_owned(),
        }),
    }
}

pub(super) fn common_vocabulary(
    models: &[NamedModel],
    parsed: &[Model<'_>],
) -> Result<Vocabulary, EvaluationError> {
    let classes = |model: &Model<'_>| model.header.dimensions.vocabulary;
    let first = parsed.first().ok_or(EvaluationError::NoModel)?;
    let other = parsed
        .iter()
        .position(|model| classes(model) != classes(first));
    match other {
        None => Ok(classes(first)),
        Some(at) => Err(EvaluationError::DifferentClasses {
            first: models[0].name.clone(),
            other: models[at].name.clone(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_model_has_the_name_of_another_row() {
        for (name, expected) in [
            ("three-class", "three-class"),
            ("energy detector", "energy detector.intent"),
            ("float student", "float student.intent"),
            ("a, aligned", "a, aligned.intent"),
            ("a (has seen them)", "a (has seen them).intent"),
        ] {
            assert_eq!(NamedModel::new(name, Vec::new()).name, expected);
        }
        let models = |names: &[&str]| {
            let named = names.iter().map(|&name| NamedModel {
                name: name.to_owned(),
                bytes: Vec::new(),
            });
            distinct(&named.collect::<Vec<_>>()).is_ok()
        };
        assert!(models(&["", "a", "b"]));
        assert!(!models(&["a", "b", "a"]));
        assert!(!models(&["a", "energy detector"]));
    }
}
