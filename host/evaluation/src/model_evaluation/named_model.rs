//! A model file with its name in tables.

use std::path::Path;

use shared::intent::Vocabulary;
use shared::model::file::Model;

use crate::EvaluationError;
use crate::integer_candidate;
use crate::results::MODEL;
use crate::{Candidate, EvaluatedRecording};
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
    /// Reads a model file; its name is the file's without the extension, and that of a run folder's model the folder's.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(path: &Path) -> std::io::Result<Self> {
        let bytes = bounded_read::read_model(path)?;
        let folder = path.parent().and_then(Path::file_name);
        let stem = path.file_stem().unwrap_or(path.as_os_str());
        let name = match folder {
            Some(folder) if path.file_name().is_some_and(|file| file == MODEL) => folder,
            _ => stem,
        };
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            bytes,
        })
    }
}

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
    let evaluated = recordings
        .iter()
        .map(|recording| recording.subject.as_str());
    match evaluated.into_iter().find(|subject| seen.contains(subject)) {
        None => integer_candidate(&model.name, &parsed, recordings),
        Some(subject) => Err(EvaluationError::Seen {
            model: model.name.clone(),
            subject: subject.to_owned(),
        }),
    }
}

/// The classes of all models.
///
/// # Errors
/// When there is no model, or two have different classes.
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
