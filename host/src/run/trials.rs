//! The recordings that a run's models are evaluated on, or that settings are chosen on.

use std::collections::BTreeMap;

use shared::stream::preprocess::clean;

use super::config::ResolvedConfig;
use crate::dataset::split::Role;
use crate::dataset::{DataSet, Library, Recording};
use crate::evaluation::Trial;

/// Held-out recordings as published.
pub(super) fn published(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::HeldOut)
}

/// Validation recordings as published, on which settings may be chosen.
pub(super) fn validation(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::Validation)
}

/// Training recordings, which the floors of the tables are fitted to.
pub(super) fn training(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::Training)
}

/// One minute of spliced recording per held-out subject. A model that has learnt the order and timing of the
/// protocol has no advantage on it.
pub(super) fn spliced(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    const SECONDS: f64 = 60.0;
    let mut by_set: BTreeMap<DataSet, Vec<&Recording>> = BTreeMap::new();
    for recording in config.labelled_recordings(library, Role::HeldOut) {
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
            other_movement: Vec::new(),
        })
        .collect()
}

fn trials(config: &ResolvedConfig, library: &Library, role: Role) -> Vec<Trial> {
    config
        .labelled_recordings(library, role)
        .into_iter()
        .map(|recording| {
            let raw = config.samples(recording);
            Trial {
                data_set: recording.data_set,
                subject: recording.subject.clone(),
                name: recording.name.clone(),
                emg: clean(raw.iter().copied()).collect(),
                raw,
                published: Some(recording.labels_in(config.preset.vocabulary())),
                lag_compensated: config.lag_compensated_labels(recording),
                other_movement: Vec::new(),
            }
        })
        .collect()
}
