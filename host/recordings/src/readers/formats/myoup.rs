//! `myoup`: 60 gestures of five seconds, five of each of twelve, marked by a pulse inside the activity.
//!
//! Published as MATLAB files (`MyoUP/E2/s1e2.mat`: `emg`, and `pulse` of 0 or 100), repacked as npy with the
//! gesture's number in place of the pulse (`s1/e2_emg.npy`, `s1/e2_ann.npy`). The pulse begins 0.25 s after the
//! muscle, so that rest is what is a second away from any.

use std::path::Path;

use shared::intent::Intent;
use shared::units::{SAMPLE_RATE_HZ, Sample};

use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::mat::Matrix;
use crate::readers::npy::{self, Array, Values};
use crate::readers::path::{numbered, stem};
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording};

/// Samples around a pulse that are no rest.
const AWAY: usize = SAMPLE_RATE_HZ as usize;
/// Person whose published file is a copy of another person's.
pub(crate) const COPIED: &str = "s2";
/// Number of pulses of each gesture in a row, and of all.
const REPETITIONS: usize = 5;
const PULSES: usize = 60;

/// The person of samples in the repacked layout.
pub(crate) fn person_of_npy(path: &Path) -> Option<&str> {
    (stem(path)? == "e2_emg").then(|| numbered(path, 1, "s"))?
}

/// Whether a file is annotations of the repacked layout.
pub(crate) fn is_annotations(path: &Path) -> bool {
    stem(path) == Some("e2_ann") && numbered(path, 1, "s").is_some()
}

/// The person of a published file.
pub(crate) fn person_of_mat(path: &Path) -> Option<&str> {
    let person = stem(path)?.strip_suffix("e2")?;
    let number = person.strip_prefix('s')?;
    number.parse::<usize>().ok().map(|_| person)
}

pub(crate) fn read_npy(path: &Path, person: &str, array: &Array) -> Result<Recording, LoadError> {
    let samples = table::samples(array).map_err(|damage| damage.in_file(path))?;
    let (partner, annotations) = npy::partner(path, "e2_ann.npy")?;
    let gestures = gestures(&annotations).map_err(|damage| damage.in_file(&partner))?;
    if gestures.len() != samples.len() {
        let fault = Fault::LabelCount {
            samples: samples.len(),
            labels: gestures.len(),
        };
        return Err(Damage::of_file(fault).in_file(&partner));
    }
    Ok(recording(path, person, samples, &gestures))
}

/// Reads a published file; its pulse may go on after the last sample.
pub(crate) fn read_mat(
    path: &Path,
    person: &str,
    matrices: &[Matrix],
) -> Result<Recording, Damage> {
    let named = |name: &str| {
        let missing = || Damage::of_file(Fault::Mat(format!("it has no {name}")));
        matrices.iter().find(|m| m.name == name).ok_or_else(missing)
    };
    let samples = table::matrix(named("emg")?, 1.0)?;
    let mut on: Vec<bool> = named("pulse")?.values.iter().map(|&v| v > 0.0).collect();
    on.resize(samples.len(), false);
    let mut gestures = Vec::with_capacity(on.len());
    let mut pulses = 0;
    for (at, &pulse) in on.iter().enumerate() {
        pulses += usize::from(pulse && (at == 0 || !on[at - 1]));
        gestures.push(if pulse {
            (pulses - 1) / REPETITIONS + 1
        } else {
            0
        });
    }
    if pulses != PULSES {
        let fault = Fault::Gestures {
            expected: PULSES,
            found: pulses,
        };
        return Err(Damage::of_file(fault));
    }
    Ok(recording(path, person, samples, &gestures))
}

fn gestures(annotations: &Array) -> Result<Vec<usize>, Damage> {
    let (&[_], Values::Numbers(values)) = (&annotations.shape[..], &annotations.values) else {
        return Err(Damage::of_file(Fault::Array {
            expected: "one gesture's number per sample",
            found: annotations.describe(),
        }));
    };
    let gesture = |(row, &value): (usize, &f64)| {
        let fault = || Fault::Label {
            expected: "0 to 12",
            found: value.to_string(),
        };
        let known = value.fract() == 0.0 && (0.0..=12.0).contains(&value);
        known
            .then_some(value as usize)
            .ok_or_else(|| Damage::at_byte(annotations.byte_of_row(row), fault()))
    };
    values.iter().enumerate().map(gesture).collect()
}

/// Motion of a gesture's number. The guide names 11 extension and 12 flexion, but their muscles show the opposite: both
/// are left out.
const fn motion(gesture: usize) -> Motion {
    match gesture {
        0 => Motion::RELAX,
        5 => Motion::Intent(Intent::Open),
        6 => Motion::Intent(Intent::Close),
        9 => Motion::Intent(Intent::WaveOut),
        10 => Motion::Intent(Intent::WaveIn),
        11 | 12 => Motion::Unknown,
        1 => Motion::Other(MovementKind::ThumbUp),
        2 => Motion::Other(MovementKind::TwoFingers),
        3 => Motion::Other(MovementKind::ThreeFingers),
        4 => Motion::Other(MovementKind::FourFingers),
        7 => Motion::Other(MovementKind::Point),
        _ => Motion::Other(MovementKind::FingersTogether),
    }
}

fn recording(path: &Path, person: &str, samples: Vec<Sample>, gestures: &[usize]) -> Recording {
    let mut motions: Vec<Motion> = gestures.iter().map(|&gesture| motion(gesture)).collect();
    let mut start = 0;
    for run in gestures.chunk_by(|a, b| a == b) {
        let end = start + run.len();
        if run[0] == 0 {
            // At either end of the recording there is no pulse to keep away from.
            let after = if start == 0 { 0 } else { AWAY };
            let before = if end == gestures.len() { 0 } else { AWAY };
            let rest = start + after..end.saturating_sub(before);
            for at in (start..end).filter(|at| !rest.contains(at)) {
                motions[at] = Motion::Unknown;
            }
        }
        start = end;
    }
    let GroundTruth {
        labels,
        other_movement,
    } = motions.into_iter().collect();
    Recording {
        name: "e2".to_owned(),
        path: path.to_owned(),
        other_movement,
        ..Recording::new(DataSet::Myoup, format!("myoup/{person}"), samples, labels)
    }
}

#[cfg(test)]
mod tests {
    use shared::units::CHANNELS;

    use super::*;
    use crate::readers::mat::{fixture, parse};

    /// 60 pulses of 300 samples, 700 of rest before each and after the last.
    fn gestures_of_a_file() -> Vec<usize> {
        let mut gestures: Vec<usize> = (0..PULSES)
            .flat_map(|pulse| [vec![0; 700], vec![pulse / REPETITIONS + 1; 300]].concat())
            .collect();
        gestures.extend([0; 700]);
        gestures
    }

    #[test]
    fn rest_keeps_a_second_away_from_a_pulse() {
        let gestures = gestures_of_a_file();
        let samples = vec![[1; CHANNELS]; gestures.len()];
        let recording = recording(Path::new("/d/s3/e2_emg.npy"), "s3", samples, &gestures);
        assert_eq!(recording.full_name(), "myoup/s3/e2");
        let relax = Some(Intent::Relax);
        let labels = &recording.labels;
        assert_eq!([labels[0], labels[499], labels[500]], [relax, relax, None]);
        assert_eq!([labels[1199], labels[1200]], [None, relax]);
        assert_eq!(labels.last(), Some(&relax));
        let first = |gesture: usize| labels[gestures.iter().position(|&g| g == gesture).unwrap()];
        let named: Vec<_> = (1..=12).map(|g| first(g).map(Intent::name)).collect();
        let expected = [5, 6, 9, 10].map(|g| named[g - 1]);
        let names = ["open", "close", "wave-out", "wave-in"].map(Some);
        assert_eq!(expected, names);
        assert_eq!(
            named.iter().flatten().count(),
            4,
            "11 and 12 are swapped: left out"
        );
        assert_eq!(recording.other_movement.len(), 6 * REPETITIONS);
    }

    #[test]
    fn a_published_file_counts_its_pulses() {
        let gestures = gestures_of_a_file();
        let emg: Vec<f64> = (0..gestures.len() * CHANNELS)
            .map(|at| (at % 9) as f64)
            .collect();
        let pulse: Vec<f64> = gestures
            .iter()
            .map(|&gesture| if gesture > 0 { 100.0 } else { 0.0 })
            .chain([0.0; 50])
            .collect();
        let file = |pulse: &[f64]| {
            fixture::file(&[
                fixture::compressed(&fixture::doubles("emg", [gestures.len() as i32, 8], &emg)),
                fixture::doubles("pulse", [pulse.len() as i32, 1], pulse),
            ])
        };
        let path = Path::new("/d/MyoUP/E2/s3e2.mat");
        let person = person_of_mat(path).unwrap();
        let published = read_mat(path, person, &parse(&file(&pulse)).unwrap()).unwrap();
        let repacked = recording(path, person, published.samples.clone(), &gestures);
        assert_eq!(published, repacked);
        let fewer = read_mat(path, person, &parse(&file(&pulse[1500..])).unwrap()).unwrap_err();
        assert!(
            matches!(fewer.fault, Fault::Gestures { found: 59, .. }),
            "{fewer:?}"
        );
    }
}
