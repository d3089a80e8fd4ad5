//! Configurations of made-up people, for tests.

use recordings::{DataSet, Library, Recording};
use shared::intent::Intent;

use super::ConfigError;
use crate::Preset;
use crate::config::ResolvedConfig;

/// Recordings of people p1, p2, p3... of a data set, one labelled recording each.
pub(crate) fn people(data_set: DataSet, count: usize) -> Vec<Recording> {
    (1..=count)
        .map(|person| {
            let subject = format!("{}/p{person}", data_set.name());
            let labels = vec![Some(Intent::Relax); 20];
            Recording::new(data_set, subject, vec![[0; 8]; 20], labels)
        })
        .collect()
}

/// Library with two data sets of the user's own.
pub(crate) fn library() -> Library {
    Library {
        recordings: [people(DataSet::OWN, 5), people(DataSet::SYNTHETIC, 4)].concat(),
        ..Library::default()
    }
}

/// Preset `quickstart` of all data sets, with these people held out and these to validate with.
///
/// # Panics
/// If the preset is not built in.
pub(crate) fn preset(held_out: &[&str], validation: &[&str]) -> Preset {
    let mut preset = Preset::find("quickstart").unwrap();
    preset.data.data_sets.clear();
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    preset.data.held_out = owned(held_out);
    preset.data.validation = owned(validation);
    preset
}

/// Configuration of the preset `quickstart` on two data sets of the user's own, with these people held out and these to
/// validate with.
pub fn resolve(held_out: &[&str], validation: &[&str]) -> Result<ResolvedConfig, ConfigError> {
    ResolvedConfig::new(preset(held_out, validation), &library(), None, false, None)
}
