//! Results of a run's models on the people whom it holds out, with their recordings and logits.

use std::collections::BTreeMap;

use recordings::DataSet;
use serde::{Deserialize, Serialize};

use crate::{Candidate, Cued, EvaluatedRecording, LookAhead, Score};

/// Name of the model file in a run folder.
pub const MODEL: &str = "student.intent";
/// The teacher's name in tables.
pub const TEACHER: &str = "teacher";
/// The float student's name in tables.
pub const STUDENT: &str = "float student";
/// The integer student's name in tables; it is what devices run.
pub const INTEGER: &str = "integer student";
/// The name in tables of a float student trained on the labels alone.
pub const LABELS_ONLY: &str = "student without teacher";
/// The name in tables of an integer student trained on the labels alone.
pub const INTEGER_LABELS_ONLY: &str = "integer student without teacher";

/// Name of [`Results`] in a run folder.
pub const RESULTS: &str = "results.json";

/// Scores of several models, as `results.json` keeps them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Held-out subjects, as `data-set/subject`.
    pub held_out: Vec<String>,
    /// The model file's aggregation mode.
    pub aggregation: LookAhead,
    /// Numbers of gestures that the held-out subjects were asked for and of those that are scored, by data set; empty
    /// in results of earlier versions.
    #[serde(default)]
    pub gestures: BTreeMap<DataSet, Cued>,
    /// Scores on recordings as published.
    pub published: Vec<Score>,
    /// Scores on spliced recordings of the same subjects.
    pub spliced: Vec<Score>,
}

/// Recordings of an evaluation, and every model's logits over them.
pub struct Evaluation {
    /// Recordings as published.
    pub recordings: Vec<EvaluatedRecording>,
    /// Every model of the run.
    pub candidates: Vec<Candidate>,
    /// The model file's aggregation mode.
    pub aggregation: LookAhead,
    /// Whether all models are the run's own, so that the results are kept in its folder.
    pub is_kept: bool,
    /// The model file, if there is one.
    pub model: Option<Vec<u8>>,
}
