//! Evaluation of the labels that any program gave for many recordings.

use std::collections::BTreeMap;

use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::{Lag, lags};
use recordings::labels::vocabulary;
use recordings::split::predefined;
use recordings::{DataSet, Library};
use serde::Serialize;
use shared::units::Sample;

use crate::model_evaluation::{evaluated_recordings, labelled};
use crate::{
    Cued, EnergyDetector, EvaluationError, LookAhead, Score, SmoothedLabels, System, constant,
    cued, score, score_labels,
};

/// Scores of a program's labels, with the floors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelResults {
    /// Labelled recordings that the program has no labels for.
    pub missing: Vec<String>,
    /// Lag compensation of the true labels, by data set.
    pub lags: BTreeMap<DataSet, Lag>,
    /// Numbers of gestures, asked for and scored, by data set.
    pub gestures: BTreeMap<DataSet, Cued>,
    /// Scores: a row for the program and each floor, for each data set and over all of them.
    pub scores: Vec<Score>,
}

/// Evaluates labels as [`evaluate_models`](crate::model_evaluation::evaluate_models) evaluates a model's. `name`
/// is the program's, `labels` has the program's labels by the recording's
/// [full name](recordings::Recording::full_name). Its classes are the smallest vocabulary of its labels.
///
/// # Errors
/// When a recording and its labels differ in length, or no recording has both.
pub fn evaluate_labels(
    name: &str,
    mut labels: BTreeMap<String, SmoothedLabels>,
    library: &Library,
    label_lag: LabelLag,
) -> Result<LabelResults, EvaluationError> {
    let all = labels.values().flat_map(|own| own.reference.iter());
    let vocabulary = vocabulary::smallest(all);
    let labelled = labelled(library, vocabulary);
    let lags = lags(&labelled, label_lag, &predefined::is_training);
    let (mut found, mut predicted, mut missing) = (Vec::new(), Vec::new(), Vec::new());
    for recording in labelled {
        match labels.remove(&recording.full_name()) {
            Some(own) => {
                found.push(recording);
                predicted.push(own);
            }
            None => missing.push(recording.full_name()),
        }
    }
    if found.is_empty() {
        return Err(EvaluationError::NoLabels {
            recordings: missing.len(),
            first: missing.first().cloned().unwrap_or_default(),
        });
    }
    let as_they_are = |_: &mut Vec<Sample>| ();
    let recordings = evaluated_recordings(&found, vocabulary, &lags, |_| Some(as_they_are));
    let program = System::Model(name.to_owned());
    let own = LookAhead::None;
    let mut scores = score_labels(&program, &predicted, &recordings, vocabulary, own)?;
    let energy = EnergyDetector::default().candidate(&recordings);
    for floor in [constant(&recordings), energy] {
        scores.extend(score(&floor, &recordings, vocabulary, own)?);
    }
    Ok(LabelResults {
        missing,
        lags,
        gestures: cued(&recordings),
        scores,
    })
}
