//! The alignment template of a model file, made anew from the people whom the model has seen.

use presets::resolve::opens;
use recordings::alignment::{FEWEST_PEOPLE, template};
use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::lags;
use recordings::split::predefined;
use recordings::{Library, Recording};
use shared::model::file::Model;

use crate::EvaluationError;

/// A model file with a template of the people whom the model has seen and of whom a library holds recordings; and the
/// number of these people. Everything else in the file stays as it is.
///
/// Electrodes are in the common frame of all data sets, as in training. A constant label lag of a set is estimated on
/// the training people among those seen.
///
/// # Errors
/// When the model is refused, or fewer than three of its people open the hand in the library.
pub fn model_with_template(
    file: &[u8],
    library: &Library,
) -> Result<(Vec<u8>, usize), EvaluationError> {
    let model = Model::parse(file)?;
    let seen: Vec<&str> = model.header.provenance.subjects_seen.iter().collect();
    let own: Vec<&Recording> = library
        .recordings
        .iter()
        .filter(|recording| seen.contains(&recording.subject.as_str()))
        .collect();
    let lags = lags(&own, LabelLag::default(), &predefined::is_training);
    let opens = opens(own.iter().copied(), |recording| {
        let lag = &lags[&recording.data_set];
        (recording.aligned_samples(), lag.of_recording(recording))
    });
    let template = template(&opens).ok_or(EvaluationError::NoTemplate {
        expected: FEWEST_PEOPLE,
        found: opens.len(),
    })?;
    Ok((Model::with_template(file, Some(&template))?, opens.len()))
}
