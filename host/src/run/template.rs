//! The alignment template of a model: of a run's training people, or of the people whom a model file has seen.

use std::collections::BTreeMap;

use shared::intent::Intent;
use shared::model::file::Model;
use shared::units::{CHANNELS, Sample};

use super::config::ResolvedConfig;
use super::error::StepError;
use super::lag::lags;
use recordings::alignment::{FEWEST_PEOPLE, open_hand, template};
use recordings::labels::compensation::Compensation;
use recordings::labels::lag::LabelLag;
use recordings::split::{Role, circles};
use recordings::{Library, Recording};

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

/// A model file with a template of the people whom the model has seen, of whom a library holds recordings; and how many of
/// them there are. Everything else in the file stays as it is.
///
/// Electrodes are in the common frame of all data sets, as in training. A constant label lag of a set is estimated on the
/// training people among those seen.
///
/// # Errors
/// When the model is refused, or fewer than three of its people open the hand in the library.
pub fn model_with_template(file: &[u8], library: &Library) -> Result<(Vec<u8>, usize), StepError> {
    let model = Model::parse(file)?;
    let seen: Vec<&str> = model.header.provenance.subjects_seen.iter().collect();
    let own: Vec<&Recording> = library
        .recordings
        .iter()
        .filter(|recording| seen.contains(&recording.subject.as_str()))
        .collect();
    let lags = lags(&own, LabelLag::default(), &circles::is_training);
    let opens = opens(own.iter().copied(), |recording| {
        let lag = &lags[&recording.data_set];
        (recording.aligned_samples(), lag.of_recording(recording))
    });
    let template = template(&opens).ok_or(StepError::NoTemplate {
        expected: FEWEST_PEOPLE,
        found: opens.len(),
    })?;
    Ok((Model::with_template(file, Some(&template))?, opens.len()))
}

/// The open hand of each person who opens it; `read` gives a recording's samples and how its labels are compensated.
fn opens<'r>(
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
