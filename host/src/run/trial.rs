//! Recordings of people whom no model has seen, ready to be judged.

use std::collections::BTreeMap;

use shared::intent::Intent;
use shared::stream::preprocess::clean;
use shared::units::{CleanSample, Sample};

use crate::run::plan::Plan;
use crate::dataset::DataSet;
use crate::dataset::Library;
use crate::dataset::Recording;

/// One recording to be judged.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Which set.
    pub data_set: DataSet,
    /// Who.
    pub subject: String,
    /// Which recording.
    pub name: String,
    /// Samples as the armband sends them.
    pub raw: Vec<Sample>,
    /// The same samples, cleaned.
    pub emg: Vec<CleanSample>,
    /// Labels as published; none for recordings that nobody published.
    pub published: Option<Vec<Option<Intent>>>,
    /// Labels moved by the data set's lag.
    pub moved: Vec<Option<Intent>>,
}

/// Held-out recordings as published.
#[must_use]
pub fn published(plan: &Plan, library: &Library) -> Vec<Trial> {
    plan.held_out(library)
        .into_iter()
        .map(|recording| trial(plan, recording))
        .collect()
}

/// Validation recordings as published: what settings may be chosen on.
#[must_use]
pub fn validation(plan: &Plan, library: &Library) -> Vec<Trial> {
    plan.validation_recordings(library)
        .into_iter()
        .map(|recording| trial(plan, recording))
        .collect()
}

/// One minute of each held-out subject in random order and rhythm: what a model that has learnt
/// the protocol by heart fails on.
#[must_use]
pub fn spliced(plan: &Plan, library: &Library) -> Vec<Trial> {
    const SECONDS: f64 = 60.0;
    let mut by_set: BTreeMap<DataSet, Vec<&Recording>> = BTreeMap::new();
    for recording in plan.held_out(library) {
        by_set
            .entry(recording.data_set)
            .or_default()
            .push(recording);
    }
    by_set
        .values()
        .flat_map(|recordings| plan.spliced(recordings, SECONDS))
        .map(|recording| Trial {
            data_set: recording.data_set,
            subject: recording.subject,
            name: recording.name,
            emg: clean(recording.samples.iter().copied()).collect(),
            raw: recording.samples,
            published: None,
            moved: recording.labels,
        })
        .collect()
}

fn trial(plan: &Plan, recording: &Recording) -> Trial {
    let raw = plan.samples(recording);
    Trial {
        data_set: recording.data_set,
        subject: recording.subject.clone(),
        name: recording.name.clone(),
        emg: clean(raw.iter().copied()).collect(),
        raw,
        published: Some(recording.labels_in(plan.preset.vocabulary())),
        moved: plan.moved_labels(recording),
    }
}
