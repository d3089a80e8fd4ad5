//! The alignment template of a run's training people.

use std::collections::BTreeMap;

use recordings::Recording;
use recordings::alignment::{open_hand, template};
use recordings::labels::compensation::Compensation;
use recordings::split::Role;
use shared::intent::Intent;
use shared::units::{CHANNELS, Sample};

use crate::config::ResolvedConfig;

/// The numbers of the template of a run's training people; none if too few of them open the hand.
pub(super) fn of_training_people(
    config: &ResolvedConfig,
    labelled: &[&Recording],
) -> Option<Vec<i16>> {
    let read = |recording: &Recording| {
        let compensation = config.compensation(recording);
        (config.samples(recording), compensation)
    };
    let is_seen =
        |recording: &&Recording| config.split.role(&recording.subject) == Some(Role::Training);
    let seen = labelled.iter().copied().filter(is_seen);
    let bytes = template(&opens(seen, read))?.to_bytes();
    let numbers = bytes.as_chunks::<2>().0.iter();
    Some(numbers.map(|&two| i16::from_le_bytes(two)).collect())
}

/// Open hand of each person who opens it; `read` gives a recording's samples and its lag compensation.
pub fn opens<'r>(
    recordings: impl Iterator<Item = &'r Recording>,
    read: impl Fn(&Recording) -> (Vec<Sample>, Compensation),
) -> Vec<[f64; CHANNELS]> {
    let mut by_person: BTreeMap<&str, Vec<&Recording>> = BTreeMap::new();
    for recording in recordings {
        let own = by_person.entry(&recording.subject).or_default();
        own.push(recording);
    }
    by_person
        .into_values()
        .filter_map(|own| {
            let streams: Vec<(Vec<Sample>, Vec<Option<Intent>>)> = own
                .iter()
                .map(|recording| {
                    let (samples, compensation) = read(recording);
                    (samples, recording.compensated(compensation).labels)
                })
                .collect();
            let borrowed = streams
                .iter()
                .map(|(samples, labels)| (samples.as_slice(), labels.as_slice()));
            open_hand(borrowed)
        })
        .collect()
}
