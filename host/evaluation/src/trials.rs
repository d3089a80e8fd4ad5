//! The recordings that a run's models are evaluated on, or that settings are chosen on.

use shared::intent::Vocabulary;
use shared::stream::preprocess::{Median, clean};
use shared::units::Sample;

use crate::Trial;
use presets::config::ResolvedConfig;
use recordings::labels::compensation::Compensation;
use recordings::split::Role;
use recordings::{Library, Recording, by_data_set};

/// Held-out recordings as published.
pub fn published(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::HeldOut)
}

/// Validation recordings as published, on which settings may be chosen.
pub fn validation(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::Validation)
}

/// Training recordings, which the floors of the tables are fitted to.
pub fn training(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    trials(config, library, Role::Training)
}

/// One minute of spliced recording per held-out subject. A model that has learnt the order and timing of the
/// protocol has no advantage on it.
pub fn spliced(config: &ResolvedConfig, library: &Library) -> Vec<Trial> {
    const SECONDS: f64 = 60.0;
    by_data_set(config.labelled_recordings(library, Role::HeldOut))
        .values()
        .flat_map(|recordings| config.spliced(recordings, SECONDS, false))
        .map(|recording| Trial {
            data_set: recording.data_set,
            subject: recording.subject,
            name: recording.name,
            emg: clean(recording.samples.iter().copied(), Median::Three).collect(),
            // Spliced from what the preset asks for, normalized or not.
            normalized: recording.samples.clone(),
            raw: recording.samples,
            published: None,
            lag_compensated: recording.labels,
            other_movement: Vec::new(),
        })
        .collect()
}

fn trials(config: &ResolvedConfig, library: &Library, role: Role) -> Vec<Trial> {
    let vocabulary = config.preset.vocabulary();
    config
        .evaluated_recordings(library, role)
        .into_iter()
        .map(|recording| {
            let compensation = config.compensation(recording);
            let align = |samples: &mut Vec<Sample>| config.align(recording, samples);
            trial(recording, align, vocabulary, compensation)
        })
        .collect()
}

/// Trial of a recording: its samples as `arrange` changes them, and its labels in a vocabulary, compensated for their
/// lag.
///
/// Intents outside the vocabulary count as movement outside it.
pub fn trial(
    recording: &Recording,
    arrange: impl Fn(&mut Vec<Sample>),
    vocabulary: Vocabulary,
    compensation: Compensation,
) -> Trial {
    let compensated = recording.compensated(compensation);
    let arranged = |mut samples: Vec<Sample>| {
        arrange(&mut samples);
        samples
    };
    let raw = arranged(recording.samples.clone());
    let normalized = arranged(recording.normalized_samples());
    Trial {
        data_set: recording.data_set,
        subject: recording.subject.clone(),
        name: recording.name.clone(),
        emg: clean(raw.iter().copied(), Median::Three).collect(),
        normalized,
        raw,
        lag_compensated: compensated.labels_in(vocabulary),
        published: Some(recording.labels_in(vocabulary)),
        other_movement: compensated.movement_outside(vocabulary),
    }
}
