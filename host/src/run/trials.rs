//! The recordings of a run that are judged, or that settings are chosen on.

use std::collections::BTreeMap;

use shared::stream::preprocess::clean;

use super::config::ResolvedConfig;
use crate::dataset::{DataSet, Library, Recording};
use crate::evaluation::trial::Trial;

/// Held-out recordings as published.
#[must_use]
pub fn published(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    config
        .held_out(library)
        .into_iter()
        .map(|recording| trial(config, recording))
        .collect()
}

/// Validation recordings as published: what settings may be chosen on.
#[must_use]
pub fn validation(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    config
        .validation_recordings(library)
        .into_iter()
        .map(|recording| trial(config, recording))
        .collect()
}

/// One minute of each held-out subject in random order and rhythm: what a model that has learnt
/// the protocol by heart fails on.
#[must_use]
pub fn spliced(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    const SECONDS: f64 = 60.0;
    let mut by_set: BTreeMap<DataSet, Vec<&Recording>> = BTreeMap::new();
    for recording in config.held_out(library) {
        by_set
            .entry(recording.data_set)
            .or_default()
            .push(recording);
    }
    by_set
        .values()
        .flat_map(|recordings| config.spliced(recordings, SECONDS))
        .map(|recording| Trial {
            data_set: recording.data_set,
            subject: recording.subject,
            name: recording.name,
            emg: clean(recording.samples.iter().copied()).collect(),
            raw: recording.samples,
            published: None,
            lag_compensated: recording.labels,
        })
        .collect()
}

fn trial(config: &ResolvedConfig, recording: &Recording) -> Trial {
    let raw = config.samples(recording);
    Trial {
        data_set: recording.data_set,
        subject: recording.subject.clone(),
        name: recording.name.clone(),
        emg: clean(raw.iter().copied()).collect(),
        raw,
        published: Some(recording.labels_in(config.preset.vocabulary())),
        lag_compensated: config.lag_compensated_labels(recording),
    }
}
