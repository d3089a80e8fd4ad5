//! `cote-allard`: one headerless file of interleaved int16 per steady hold, class in the name.
//!
//! Classes repeat every seven files. No file holds a transition.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;
use shared::units::CHANNELS;

use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault};
use crate::readers::path::{folder, stem};
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording, Timing};

const ROW_BYTES: usize = 2 * CHANNELS;

pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Recording, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::CoteAllard.name(),
            example: "EvaluationDataset/Male3/training0/classe_12.dat",
        })
    };
    let class = stem(path).and_then(class_number).ok_or_else(misplaced)?;
    let session = folder(path, 1).ok_or_else(misplaced)?;
    let person = folder(path, 2).ok_or_else(misplaced)?;
    let part = match folder(path, 3) {
        Some("EvaluationDataset") => 'E',
        Some("PreTrainingDataset") => 'P',
        _ => return Err(misplaced()),
    };

    let whole = bytes.len() / ROW_BYTES * ROW_BYTES;
    if whole != bytes.len() {
        let expected = (whole + ROW_BYTES) as u64;
        let fault = Fault::Length {
            expected,
            found: bytes.len() as u64,
        };
        return Err(Damage::at_byte(whole as u64, fault));
    }
    let mut samples = Vec::with_capacity(bytes.len() / ROW_BYTES);
    for (row, values) in bytes.chunks_exact(ROW_BYTES).enumerate() {
        let mut sample = [0; CHANNELS];
        for (channel, pair) in values.chunks_exact(2).enumerate() {
            let value = i16::from_le_bytes([pair[0], pair[1]]);
            sample[channel] = i8::try_from(value).map_err(|_| {
                let byte = row * ROW_BYTES + 2 * channel;
                let fault = Fault::Range {
                    field: channel + 1,
                    value: f64::from(value),
                };
                Damage::at_byte(byte as u64, fault)
            })?;
        }
        samples.push(sample);
    }
    let GroundTruth {
        labels,
        other_movement,
    } = samples.iter().map(|_| motion(class)).collect();
    Ok(Recording {
        data_set: DataSet::CoteAllard,
        subject: format!("cote-allard/{part}-{person}"),
        name: format!("{session}/classe_{class}"),
        path: path.to_owned(),
        labels,
        samples,
        notes: notes(part, person),
        other_movement,
        timing: Timing::Cues,
        findings: Vec::new(),
        wearer: Normalizer::new(),
    })
}

fn notes(part: char, person: &str) -> Vec<String> {
    match (part, person) {
        ('E', "Male7") => vec!["wears the band rotated by about four channels".to_owned()],
        _ => Vec::new(),
    }
}

/// Whether a file is called as those of the set.
pub(crate) fn is_named(path: &Path) -> bool {
    stem(path).and_then(class_number).is_some()
}

/// Class number `N` of a name `classe_N`.
fn class_number(name: &str) -> Option<usize> {
    name.strip_prefix("classe_")?.parse().ok()
}

/// Motion of a class. Radial (1) and ulnar (3) deviation are outside the six classes.
const fn motion(class: usize) -> Motion {
    match class % 7 {
        0 => Motion::RELAX,
        2 => Motion::Intent(Intent::WaveIn),
        4 => Motion::Intent(Intent::WaveOut),
        5 => Motion::Intent(Intent::Close),
        6 => Motion::Intent(Intent::Open),
        1 => Motion::Other(MovementKind::RadialDeviation),
        _ => Motion::Other(MovementKind::UlnarDeviation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::movement::Movement;

    const PATH: &str = "/d/EvaluationDataset/Male3/Test0/classe_13.dat";

    fn bytes(values: &[i16]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    #[test]
    fn samples_are_interleaved_little_endian_words() {
        let recording = read(
            Path::new(PATH),
            &bytes(&[-128, 127, 0, 1, 2, 3, 4, 5, 8, 8, 8, 8, 8, 8, 8, -1]),
        )
        .unwrap();
        assert_eq!(
            recording.samples,
            [[-128, 127, 0, 1, 2, 3, 4, 5], [8, 8, 8, 8, 8, 8, 8, -1]]
        );
        assert_eq!(recording.labels, [Some(Intent::Open); 2]);
        assert_eq!(recording.subject, "cote-allard/E-Male3");
    }

    #[test]
    fn a_deviation_is_other_movement() {
        let path = PATH.replace("classe_13", "classe_15");
        let recording = read(Path::new(&path), &bytes(&[0; 16])).unwrap();
        assert!(!recording.has_labels());
        let radial = Movement::new(MovementKind::RadialDeviation, 0..2);
        assert_eq!(recording.other_movement, [radial]);
    }

    #[test]
    fn a_cut_row_and_a_large_value_name_their_byte() {
        let cut = read(Path::new(PATH), &bytes(&[0; 9])).unwrap_err();
        assert_eq!(
            cut,
            Damage::at_byte(
                16,
                Fault::Length {
                    expected: 32,
                    found: 18
                }
            )
        );
        let mut values = [0; 16];
        values[10] = 300;
        let large = read(Path::new(PATH), &bytes(&values)).unwrap_err();
        assert_eq!(
            large,
            Damage::at_byte(
                20,
                Fault::Range {
                    field: 3,
                    value: 300.0
                }
            )
        );
    }
}
