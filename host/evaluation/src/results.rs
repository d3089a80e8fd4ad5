//! Results of a run's models on the people whom it holds out, with their recordings and logits.

use std::collections::BTreeMap;

use recordings::DataSet;
use serde::{Deserialize, Serialize};

use crate::{Candidate, Cued, EvaluatedRecording, LookAhead, Score};

/// Name of the model file in a run folder.
pub const MODEL: &str = "student.intent";

/// Name of [`Results`] in a run folder.
pub const RESULTS: &str = "results.json";

/// Scores of several models, as `results.json` keeps them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Held-out subjects, as `data-set/subject`.
    pub held_out: Vec<String>,
    /// The model file's aggregation mode.
    pub aggregation: LookAhead,
    /// Numbers of gestures of the held-out subjects, asked for and scored, by data set; empty
    /// in results of earlier versions.
    #[serde(default)]
    pub gestures: BTreeMap<DataSet, Cued>,
    /// Scores on recordings as published.
    pub published: Vec<Score>,
}

/// Recordings of an evaluation, and every model's logits over them.
pub struct Evaluation {
    /// Recordings as published.
    pub recordings: Vec<EvaluatedRecording>,
    /// Every model of the run.
    pub candidates: Vec<Candidate>,
    /// Whether all models are the run's own, so that the results are kept in its folder.
    pub is_kept: bool,
}
