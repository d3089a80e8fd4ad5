//! Every published set: what is read of it, and how its labels are moved.

use std::collections::BTreeMap;

use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::Lag;
use recordings::movement::MovementKind;
use recordings::split::predefined;
use recordings::{Library, Recording, runs};
use serde::Deserialize;
use shared::intent::Intent;

use super::read;

/// Contents of a set as they are read; `sets.toml` has those of all.
#[derive(Deserialize, PartialEq, Debug)]
struct Contents {
    people: usize,
    recordings: usize,
    /// Files left out as damaged, and recordings left out as copies.
    left_out: [usize; 2],
    /// Compensation of the labels' lag.
    lag: String,
    /// Seconds and stretches of each label and other movement; `none` is where there is no label.
    labels: BTreeMap<String, [usize; 2]>,
}

impl Contents {
    fn of(library: &Library) -> Self {
        let mut samples: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
        let mut add = |name, count| {
            let [sum, stretches] = samples.entry(name).or_default();
            *sum += count;
            *stretches += 1;
        };
        for own in &library.recordings {
            for run in runs(&own.labels) {
                add(run.label.map_or("none", Intent::name), run.samples());
            }
            for own in &own.other_movement {
                add(MovementKind::name(own.kind), own.samples.len());
            }
        }
        let labels = samples.into_iter().map(|(name, [samples, stretches])| {
            let seconds = (samples as f64 / 200.0).round() as usize;
            (name.to_owned(), [seconds, stretches])
        });
        let all: Vec<&Recording> = library.recordings.iter().collect();
        let how = LabelLag::default();
        let lag = Lag::of(all[0].data_set, &all, how, &predefined::is_training);
        Self {
            people: library.subjects().len(),
            recordings: all.len(),
            left_out: [library.skipped.len(), library.repeats.len()],
            lag: lag.to_string(),
            labels: labels.collect(),
        }
    }
}

#[test]
fn every_set_has_the_people_recordings_and_labels_of_its_description() {
    let sets: BTreeMap<String, Contents> = toml::from_str(include_str!("sets.toml")).unwrap();
    std::thread::scope(|scope| {
        for (set, expected) in sets {
            scope.spawn(move || {
                if let Some(library) = read(&set) {
                    assert_eq!(Contents::of(library), expected, "{set}");
                }
            });
        }
    });
}
