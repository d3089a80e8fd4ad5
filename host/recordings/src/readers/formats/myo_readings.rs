//! `myo-readings`: one text per minute and gesture, eight integers and the label in each line.
//!
//! Files of a motion outside the six classes (labels 3 to 6: radial and ulnar deviation, pronation,
//! supination) say where that is; the rest between is not labelled, so that no rest is trained on that the
//! published scores do not know.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::alignment::Alignment;
use shared::stream::normalizer::Normalizer;
use shared::units::Sample;

use crate::catalogue::DataSet;
use crate::examiner::finding::Finding;
use crate::examiner::repeats::first_of_each;
use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault};
use crate::readers::path::{folder, is_number, left_arm, stem};
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{Recording, Timing};

/// People whose labels do not mark when the gesture happens, and why.
const UNUSABLE: [(&str, &str); 4] = [
    ("32185", "runs of 6 s, steadily 1.6 s late"),
    ("35622", "the muscle drifts 4 s late within a file"),
    (
        "46666",
        "1.5 to 1.9 s early at the end, runs of 1010 to 1455 lines",
    ),
    (
        "60186",
        "1.5 to 1.9 s early at the end, runs of 1010 to 1455 lines",
    ),
];
/// People whose gestures hardly rise above rest.
const WEAK: [&str; 7] = [
    "10000", "45678", "48584", "45677", "14478", "78454", "45744",
];
/// Files with misplaced newlines in the published copy.
const PUBLISHED_DAMAGE: [&str; 4] = [
    "19999-2/2.txt",
    "64917-1/2.txt",
    "64917-2/1.txt",
    "64917-3/7.txt",
];
/// Names and labels of files with a motion outside the six classes.
const OUTSIDE: [(&str, f64, MovementKind); 4] = [
    ("3", 3.0, MovementKind::RadialDeviation),
    ("4", 4.0, MovementKind::UlnarDeviation),
    ("5", 5.0, MovementKind::Pronation),
    ("6", 6.0, MovementKind::Supination),
];
/// Share of repeated rows from which a file was polled faster than the armband sends: at 250 Hz
/// every fifth row repeats; a true repeat of eight values is rare outside silence.
const POLLED_TOO_FAST: f64 = 0.15;

/// Placement that turns the left arm's ring into the right arm's: it runs the other way round, about the same electrode
/// as in `uci-gestures` (`electrodes.rs`).
const MIRRORED: Alignment = Alignment::new(6, true);

/// Whether a path is one of the set: `12345-1/7.txt`.
pub(crate) fn is_named(path: &Path) -> bool {
    person_and_sitting(path).is_some()
}

/// Person, sitting and name of the file.
fn person_and_sitting(path: &Path) -> Option<(&str, &str, &str)> {
    let (person, sitting) = folder(path, 1)?.rsplit_once('-')?;
    let numbered = is_number(person) && is_number(sitting);
    numbered.then_some((person, sitting, stem(path)?))
}

pub(crate) fn read(path: &Path, text: &str) -> Result<Recording, Damage> {
    recording(path, text).map_err(|damage| Damage {
        as_published: !left_arm(path) && PUBLISHED_DAMAGE.iter().any(|name| path.ends_with(name)),
        ..damage
    })
}

fn recording(path: &Path, text: &str) -> Result<Recording, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::named("myo-readings").name(),
            example: "12345-1/7.txt",
        })
    };
    let (person, sitting, name) = person_and_sitting(path).ok_or_else(misplaced)?;
    let is_left = left_arm(path);
    let mut samples = Vec::new();
    let mut motions = Vec::new();
    for (line, row) in table::rows(text) {
        let values = table::numbers::<9>(line, row)?;
        let sample =
            table::sample(&values[..8], 1).map_err(|fault| Damage::at_line(line, fault))?;
        samples.push(if is_left {
            MIRRORED.apply(sample)
        } else {
            sample
        });
        motions.push(motion(name, values[8]).map_err(|fault| Damage::at_line(line, fault))?);
    }
    let outside = motions
        .iter()
        .any(|motion| matches!(motion, Motion::Other(_)));
    if outside {
        for motion in motions
            .iter_mut()
            .filter(|motion| **motion == Motion::RELAX)
        {
            *motion = Motion::Unknown;
        }
    }
    let (mut notes, mut findings) = (Vec::new(), Vec::new());
    if is_left {
        notes.push(
            "left arm: the channels are mirrored, c is 6 - c of the right arm (modulo 8)"
                .to_owned(),
        );
    }
    let dropped = drop_polling_repeats(&mut samples, &mut motions);
    if dropped > 0 {
        findings.push(Finding::Polled {
            times: (samples.len() + dropped) as f64 / samples.len() as f64,
            dropped,
        });
    }
    let gestures = motions.iter().any(|&motion| motion != Motion::RELAX);
    if let Some((_, why)) = UNUSABLE.iter().find(|(id, _)| gestures && *id == person) {
        motions.fill(Motion::Unknown);
        notes.push(format!("labels left out: {why}"));
    }
    if gestures && WEAK.contains(&person) {
        notes.push("little muscle signal in the gestures".to_owned());
    }
    let GroundTruth {
        labels,
        other_movement,
    } = motions.into_iter().collect();
    Ok(Recording {
        data_set: DataSet::named("myo-readings"),
        subject: format!("myo-readings/{person}"),
        name: format!("{}{sitting}/{name}", if is_left { "left/" } else { "" }),
        path: path.to_owned(),
        samples,
        labels,
        notes,
        other_movement,
        timing: Timing::Cues,
        findings,
        wearer: Normalizer::new(),
    })
}

fn motion(name: &str, label: f64) -> Result<Motion, Fault> {
    let outside = OUTSIDE.iter();
    let mut outside = outside.filter(|(own, value, _)| *own == name && *value == label);
    if let Some((.., kind)) = outside.next() {
        return Ok(Motion::Other(*kind));
    }
    // Labels are small whole numbers; anything else is a damaged line.
    match label {
        0.0 => Ok(Motion::RELAX),
        1.0 => Ok(Motion::Intent(Intent::WaveIn)),
        2.0 => Ok(Motion::Intent(Intent::WaveOut)),
        7.0 => Ok(Motion::Intent(Intent::Close)),
        _ => Err(Fault::Label {
            expected: "0, 1, 2, 7",
            found: label.to_string(),
        }),
    }
}

/// Drops repeated rows if polling made them, which their share shows; returns their number.
fn drop_polling_repeats(samples: &mut Vec<Sample>, motions: &mut Vec<Motion>) -> usize {
    let repeats = samples.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if (repeats as f64) < POLLED_TOO_FAST * samples.len() as f64 {
        return 0;
    }
    let keep = first_of_each(samples);
    let mut kept = keep.iter();
    samples.retain(|_| *kept.next().unwrap_or(&true));
    let mut kept = keep.iter();
    motions.retain(|_| *kept.next().unwrap_or(&true));
    repeats
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readers::error::Place;
    use crate::recording::movement::Movement;

    #[test]
    fn either_line_end_and_spaces_are_taken() {
        let text = "-3, 1, -2, 4, 0, 2, 0, -2, 0\r\n1,2,3,4,5,6,7,-128,7";
        let recording = read(Path::new("/d/12345-2/7.txt"), text).unwrap();
        assert_eq!(
            recording.samples,
            [[-3, 1, -2, 4, 0, 2, 0, -2], [1, 2, 3, 4, 5, 6, 7, -128]]
        );
        assert_eq!(recording.labels, [Some(Intent::Relax), Some(Intent::Close)]);
        assert_eq!(
            (recording.subject.as_str(), recording.name.as_str()),
            ("myo-readings/12345", "2/7")
        );
    }

    #[test]
    fn a_lost_newline_names_its_line() {
        let text = "0,0,0,0,0,0,0,0,0\n4,2,1,0,-1,0,0,0,00,3,2,0,1,1,-1,0,0\n";
        let fault = Fault::Fields {
            expected: 9,
            found: 17,
        };
        let own = read(Path::new("/d/19999-2/12.txt"), text).unwrap_err();
        assert_eq!(own, Damage::at_line(2, fault));
        let published = read(Path::new("/d/19999-2/2.txt"), text).unwrap_err();
        assert!(published.as_published);
    }

    #[test]
    fn a_motion_outside_the_six_classes_is_other_movement_without_labels() {
        let text = "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,4\n";
        let recording = read(Path::new("/d/12345-1/4.txt"), text).unwrap();
        assert!(!recording.has_labels());
        let ulnar = Movement::new(MovementKind::UlnarDeviation, 1..2);
        assert_eq!(recording.other_movement, [ulnar]);
        let misplaced = read(Path::new("/d/12345-1/7.txt"), text).unwrap_err();
        assert_eq!(misplaced.place, Place::Line(2));
    }

    #[test]
    fn rows_doubled_by_fast_polling_are_dropped_with_their_labels() {
        let text: String = (0..100)
            .map(|row| {
                format!(
                    "{},0,0,0,0,0,0,0,{}\n",
                    row - row / 5,
                    if row < 50 { 0 } else { 1 }
                )
            })
            .collect();
        let recording = read(Path::new("/d/69069-1/1.txt"), &text).unwrap();
        let naive: Vec<i8> = (0..81).collect();
        let first: Vec<i8> = recording.samples.iter().map(|s| s[0]).collect();
        assert_eq!(first, naive[..first.len()]);
        assert_eq!(recording.samples.len(), recording.labels.len());
        assert!(matches!(recording.findings[..], [Finding::Polled { .. }]));
    }

    #[test]
    fn labels_known_to_drift_are_left_out_but_not_those_of_pure_rest() {
        let gesture = read(
            Path::new("/d/35622-1/1.txt"),
            "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,1",
        )
        .unwrap();
        assert!(!gesture.has_labels());
        assert_eq!(gesture.notes.len(), 1);
        let rest = read(
            Path::new("/d/35622-1/0.txt"),
            "0,0,0,0,0,0,0,0,0\n0,1,0,0,0,0,0,0,0",
        )
        .unwrap();
        assert!(rest.has_labels());
    }
}
