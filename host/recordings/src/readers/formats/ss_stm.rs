//! `ss-stm`: one csv per trial, 1000 rows of eight decimals (byte / 128), gesture in the name.
//!
//! Times are nominal: rest 0-1 s, motion 1-3 s, rest 3-5 s. A motion outside the six classes is
//! released at an unknown time, so nothing after its start is labelled.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;

use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault};
use crate::readers::path::{numbered, stem};
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording, Timing};

/// First sample of the motion, and of the rest after it.
const MOTION: std::ops::Range<usize> = 200..600;
/// Rows of every published file.
const ROWS: usize = 1000;

pub(crate) fn read(path: &Path, text: &str) -> Result<Recording, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::SsStm.name(),
            example: "sub7/M8T1.csv",
        })
    };
    let (person, name, motion) = person_and_motion(path).ok_or_else(misplaced)?;

    let mut samples = Vec::with_capacity(ROWS);
    for (line, row) in table::rows(text) {
        let counts = table::numbers::<8>(line, row)?.map(|value| value * 128.0);
        samples.push(table::sample(&counts, 1).map_err(|fault| Damage::at_line(line, fault))?);
    }
    let mut notes = Vec::new();
    if samples.len() != ROWS {
        notes.push(format!(
            "{} rows where the published files have {ROWS}",
            samples.len()
        ));
    }
    let GroundTruth {
        labels,
        other_movement,
    } = truth(motion, samples.len());
    Ok(Recording {
        data_set: DataSet::SsStm,
        subject: format!("ss-stm/{person}"),
        name: name.to_owned(),
        path: path.to_owned(),
        labels,
        samples,
        notes,
        other_movement,
        timing: Timing::Cues,
        findings: Vec::new(),
        wearer: Normalizer::new(),
    })
}

/// Whether a path is one of the set.
pub(crate) fn is_named(path: &Path) -> bool {
    person_and_motion(path).is_some()
}

/// Person, name and motion of a path like `sub7/M8T1.csv`.
fn person_and_motion(path: &Path) -> Option<(&str, &str, usize)> {
    let name = stem(path)?;
    Some((numbered(path, 1, "sub")?, name, motion_number(name)?))
}

/// Motion `x` of a name `MxTy`, 1..=8.
fn motion_number(name: &str) -> Option<usize> {
    let (motion, trial) = name.strip_prefix('M')?.split_once('T')?;
    trial.parse::<usize>().ok()?;
    motion.parse().ok().filter(|m| (1..=8).contains(m))
}

fn truth(motion: usize, samples: usize) -> GroundTruth {
    let (gesture, after) = match motion {
        1 => (Motion::RELAX, Motion::RELAX),
        2 => (Motion::Intent(Intent::WaveIn), Motion::RELAX),
        3 => (Motion::Intent(Intent::WaveOut), Motion::RELAX),
        8 => (Motion::Intent(Intent::Close), Motion::RELAX),
        4 => (
            Motion::Other(MovementKind::RadialDeviation),
            Motion::Unknown,
        ),
        5 => (Motion::Other(MovementKind::UlnarDeviation), Motion::Unknown),
        6 => (Motion::Other(MovementKind::Pronation), Motion::Unknown),
        _ => (Motion::Other(MovementKind::Supination), Motion::Unknown),
    };
    (0..samples)
        .map(|sample| match sample {
            s if s < MOTION.start => Motion::RELAX,
            s if s < MOTION.end => gesture,
            _ => after,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::movement::Movement;

    fn text(rows: usize) -> String {
        "-0.015625,0.9921875,-1,0,0,0,0,0.0546875\n".repeat(rows)
    }

    #[test]
    fn decimals_are_the_armbands_bytes_over_128() {
        let recording = read(Path::new("/d/sub7/M8T1.csv"), &text(1000)).unwrap();
        assert_eq!(recording.samples[999], [-2, 127, -128, 0, 0, 0, 0, 7]);
        assert_eq!(recording.subject, "ss-stm/sub7");
        assert!(recording.notes.is_empty());
    }

    #[test]
    fn nothing_is_labelled_after_the_start_of_a_motion_outside_the_six() {
        let close = truth(8, 1000).labels;
        assert_eq!(close[199], Some(Intent::Relax));
        assert_eq!(
            (close[200], close[599]),
            (Some(Intent::Close), Some(Intent::Close))
        );
        assert_eq!(close[600], Some(Intent::Relax));
        let pronation = truth(6, 1000);
        assert_eq!(pronation.labels[199], Some(Intent::Relax));
        assert!(pronation.labels[200..].iter().all(Option::is_none));
        let movement = Movement::new(MovementKind::Pronation, 200..600);
        assert_eq!(pronation.other_movement, [movement]);
        assert!(
            truth(1, 10)
                .labels
                .iter()
                .all(|&l| l == Some(Intent::Relax))
        );
    }

    #[test]
    fn a_value_off_the_grid_names_line_and_field() {
        let broken = text(3) + "0,0,0.3,0,0,0,0,0\n";
        let damage = read(Path::new("/d/sub7/M8T1.csv"), &broken).unwrap_err();
        assert_eq!(
            damage,
            Damage::at_line(
                4,
                Fault::Range {
                    field: 3,
                    value: 38.4
                }
            )
        );
    }
}
