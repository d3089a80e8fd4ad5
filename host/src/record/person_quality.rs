//! Quality of guided recordings, judged from their files: all recordings of a person count together.

use std::collections::BTreeMap;

use shared::units::{CHANNELS, Sample};

use recordings::description::own::{MOVEMENT_COLUMN, RECORDER_COLUMNS};
use recordings::labels::cued::follow;
use recordings::labels::motion::{Motion, motions};
use recordings::{DataSet, Library, Recording};
use web::record::assembly::{AssembledRecording, Assembly};
use web::record::quality::{Quality, judge};

/// Guided recordings of a person.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct PersonQuality {
    /// Data set and person.
    pub(crate) person: String,
    /// Number of files.
    pub(crate) files: usize,
    /// Quality of all of them together.
    pub(crate) quality: Quality,
}

/// Judges the guided recordings of a library, person by person in alphabetical order; skips other recordings.
///
/// The files do not tell whether a session ended early, and of lost samples they have only the bridged ones.
pub(crate) fn quality_by_person(library: &Library) -> Vec<PersonQuality> {
    let mut people: BTreeMap<&str, Assembly> = BTreeMap::new();
    // Files of this layout are read as these sets: no other file is opened again.
    let is_own =
        |recording: &&Recording| matches!(recording.data_set, DataSet::OWN | DataSet::SYNTHETIC);
    for recording in library.recordings.iter().filter(is_own) {
        let Some(part) = part(recording) else {
            continue;
        };
        let assembly = people.entry(&recording.subject).or_default();
        assembly.lost += part.bridged.iter().filter(|&&bridged| bridged).count() as u64;
        assembly.parts.push(part);
        assembly.complete = true;
    }
    let judged = people.into_iter().map(|(person, assembly)| PersonQuality {
        person: person.to_owned(),
        files: assembly.parts.len(),
        quality: judge(&assembly),
    });
    judged.collect()
}

/// Reads a file of the layout; none for another layout, or if it cannot be read any more.
fn part(recording: &Recording) -> Option<AssembledRecording> {
    let mut rows = csv::Reader::from_path(&recording.path).ok()?;
    let header = rows.headers().ok()?.clone();
    let position = |name: &str| header.iter().position(|own| own == name);
    let columns = RECORDER_COLUMNS.map(position);
    let [index, cue, trial, used, bridged] = columns.into_iter().collect::<Option<Vec<_>>>()?[..]
    else {
        return None;
    };
    let mut channels = [0; CHANNELS];
    for (channel, column) in channels.iter_mut().enumerate() {
        *column = position(&format!("emg_{channel}"))?;
    }
    let mut part = AssembledRecording {
        motions: motions(&recording.labels, &recording.other_movement),
        ..AssembledRecording::default()
    };
    let movement = position(MOVEMENT_COLUMN);
    let mut is_used = Vec::new();
    for row in rows.records() {
        let row = row.ok()?;
        let number = |column: usize| row.get(column)?.trim().parse::<i64>().ok();
        let mut sample: Sample = [0; CHANNELS];
        for (value, &column) in sample.iter_mut().zip(&channels) {
            *value = i8::try_from(number(column)?).ok()?;
        }
        part.samples.push(sample);
        part.index.push(u32::try_from(number(index)?).ok()?);
        part.bridged.push(number(bridged)? != 0);
        let name = movement.and_then(|column| row.get(column));
        part.cues.push(cued(number(cue)?, name.unwrap_or("")));
        part.trials.push(u32::try_from(number(trial)?).ok()?);
        is_used.push(number(used)? != 0);
    }
    let mut holds = follow(&part.samples, &part.cues).holds;
    holds.retain(|hold| is_used.get(hold.samples.start) == Some(&true));
    part.holds = holds;
    Some(part)
}

/// Motion that was asked for, by its number and, for other movement, its name.
fn cued(number: i64, name: &str) -> Motion {
    match Motion::from_number(number) {
        Some(Motion::OTHER) => Motion::from_name(name).unwrap_or(Motion::OTHER),
        motion => motion.unwrap_or(Motion::Unknown),
    }
}
