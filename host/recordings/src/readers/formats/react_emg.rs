//! Recordings of the user's own, and ReactEMG's (ROAM-EMG and what the reference converts): a table whose columns are
//! known by their names, `gt` and `emg_0`..`emg_7` in ReactEMG's, or npy with the label first, then eight channels,
//! under ReactEMG's names of files.
//!
//! The folder names the person, once all files are known (`library/people.rs`). Values are the armband's counts. Label
//! -1 is unlabelled, -2 other movement. Columns besides channels and label are ignored, with four exceptions. [`MUSCLE_COLUMN`] marks
//! synthetic recordings. [`RECORDER_COLUMNS`] mark labels of the muscle, and beside them [`MOVEMENT_COLUMN`] names other
//! movement. By [`TURN_COLUMN`] and [`MIRRORED_COLUMN`] the channels are turned as by an aligned board.

use std::path::Path;

use execution::printable::printable;
use shared::stream::alignment::Alignment;
use shared::stream::normalizer::Normalizer;
use shared::units::{CHANNELS, Sample};

use crate::catalogue::DataSet;
use crate::examiner::finding::Finding;
use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{Damage, Fault};
use crate::readers::label_file::{from_number, from_text};
use crate::readers::npy::{Array, Values};
use crate::readers::path::{is_number, left_arm, stem};
use crate::readers::table::auxiliary::AuxiliaryColumns;
use crate::readers::table::columns::Columns;
use crate::readers::table::one_hot::{self, OneHot};
use crate::readers::table::{self, Samples};
use crate::recording::{Recording, Timing};

/// Further column of synthetic recordings: class number of the intent that the muscle follows.
pub const MUSCLE_COLUMN: &str = "synthetic_muscle";

/// Column of recordings by `myointent record`: places by which the armband is turned, as the board was aligned.
pub const TURN_COLUMN: &str = "turn";

/// Column of recordings by `myointent record`: 1 if the armband is on the other arm.
pub const MIRRORED_COLUMN: &str = "mirrored";

/// Column of recordings by `myointent record`: name of the movement where the label is -2.
pub const MOVEMENT_COLUMN: &str = "movement";

/// Columns that `myointent record` writes behind the channels. The labels beside them are the muscle's.
pub const RECORDER_COLUMNS: [&str; 5] = ["sample", "cue", "trial", "used", "bridged"];

/// Note of a recording in a folder or file that is named after the left arm.
const LEFT: &str = "named after the left arm, read as it is: if the armband was on the left arm, add columns turn (6) and mirrored (1)";

/// Reads a table of these columns, sample by sample.
pub(crate) fn read_csv(
    path: &Path,
    text: &str,
    columns: &Columns,
) -> Result<Vec<Recording>, Damage> {
    let placements = columns
        .position(TURN_COLUMN)
        .zip(columns.position(MIRRORED_COLUMN));
    let has = |name: &&str| columns.position(name).is_some();
    let is_recorded = RECORDER_COLUMNS.iter().all(has);
    let movement = columns.position(MOVEMENT_COLUMN).filter(|_| is_recorded);
    let (mut samples, mut labels, mut has_numbers) = (Samples::default(), Vec::new(), false);
    let (mut placed, mut auxiliary) = (Vec::new(), AuxiliaryColumns::find(columns));
    let mut one_hot = OneHot::find(columns);
    for row in columns.rows(text) {
        let (line, fields) = row?;
        let at_line = |fault| Damage::at_line(line, fault);
        let number = |column: usize| {
            table::number(line, column + 1, &columns.separator.number(fields[column]))
        };
        let mut counts = [0.0; CHANNELS];
        for (count, &column) in counts.iter_mut().zip(&columns.channels) {
            *count = number(column)?;
        }
        samples.push(&counts, columns.channels[0] + 1, at_line);
        auxiliary.push(columns.separator, &fields);
        one_hot.push(&fields);
        let placement = match placements {
            None => Alignment::NONE,
            Some((turn, mirrored)) => {
                let (turn, mirrored) = (number(turn)?, number(mirrored)?);
                placement(turn, mirrored)
                    .ok_or_else(|| at_line(Fault::Placement { turn, mirrored }))?
            }
        };
        placed.push(placement);
        labels.push(match columns.label {
            None => Motion::Unknown,
            Some(column) => {
                has_numbers |= fields[column].parse::<f64>().is_ok();
                let motion = from_text(fields[column]).map_err(at_line)?;
                let name = movement.map_or("", |column| fields[column]);
                if motion == Motion::OTHER && !name.is_empty() {
                    from_text(name).map_err(at_line)?
                } else {
                    motion
                }
            }
        });
    }
    let one_hot = one_hot.finish();
    if let Some(one_hot::Found::Labels(found, _)) = &one_hot {
        labels.clone_from(found);
    }
    let data_set = if columns.position(MUSCLE_COLUMN).is_some() {
        DataSet::SYNTHETIC
    } else {
        DataSet::OWN
    };
    let placed = samples.finish()?.into_iter().zip(placed);
    let samples = placed.map(|(sample, placement)| placement.apply(sample));
    let mut recording = own(
        path,
        data_set,
        samples.collect(),
        labels.into_iter().collect(),
    )?;
    if is_recorded {
        recording.timing = Timing::Muscle;
    }
    match one_hot {
        Some(one_hot::Found::Labels(_, note)) => recording.notes.push(printable(&note)),
        Some(one_hot::Found::Unread(why)) => recording.findings.push(Finding::Known(why)),
        None => {}
    }
    let label = columns.label.and_then(|column| columns.names.get(column));
    if let Some(label) = label.filter(|label| has_numbers && *label != "gt") {
        recording.notes.push(format!(
            "numbers in column {} are read as 0 relax, 1 open, 2 close, 3 wave-in, 4 wave-out, 5 pinch, -1 unknown, -2 other",
            excerpt(label)
        ));
    }
    divided(recording, &auxiliary)
}

/// The recording, or its pieces where its clock leaps.
fn divided(recording: Recording, auxiliary: &AuxiliaryColumns) -> Result<Vec<Recording>, Damage> {
    let rows = auxiliary
        .rows(&recording.samples)
        .map_err(Damage::refused)?;
    Ok(rows.apply(recording))
}

/// Placement by the two columns; none if it is not one of the 16.
fn placement(turn: f64, mirrored: f64) -> Option<Alignment> {
    let places = 0..CHANNELS as u8;
    let turn = places.into_iter().find(|&place| f64::from(place) == turn)?;
    let mirrored = [0.0, 1.0].iter().position(|&known| known == mirrored)?;
    Some(Alignment::new(turn, mirrored == 1))
}

/// Whether an array is one of ReactEMG's: label and eight channels under a name of theirs, `s3_grasp_1.npy` or
/// `trainingSamples_idx_1_open.npy`, and labels in most of its first rows. Elsewhere nine columns may mean anything.
pub(crate) fn is_recording(path: &Path, array: &Array) -> bool {
    const EXAMINED: usize = 20;
    let (Values::Numbers(values), &[_, COLUMNS]) = (&array.values, &array.shape[..]) else {
        return false;
    };
    let Some((first, _)) = stem(path).and_then(|name| name.split_once('_')) else {
        return false;
    };
    let is_numbered = first.strip_prefix(['s', 'S']).is_some_and(is_number);
    if !is_numbered && !["trainingSamples", "testingSamples"].contains(&first) {
        return false;
    }
    let rows = values.chunks_exact(COLUMNS).take(EXAMINED);
    let labelled = rows.clone().filter(|row| from_number(row[0]).is_ok());
    2 * labelled.count() > rows.len()
}

/// Columns of an array: label and channels.
const COLUMNS: usize = CHANNELS + 1;

/// Reads (n, 9): label and channels.
pub(crate) fn read_npy(path: &Path, array: &Array) -> Result<Vec<Recording>, Damage> {
    let (Values::Numbers(values), &[_, COLUMNS]) = (&array.values, &array.shape[..]) else {
        return Err(Damage::of_file(Fault::Array {
            expected: "numbers, (n, 9)",
            found: array.describe(),
        }));
    };
    let (mut samples, mut labels) = (Samples::default(), Vec::new());
    for (row, values) in values.chunks_exact(COLUMNS).enumerate() {
        let byte = array.byte_of_row(row);
        let in_row = |fault| Damage::at_byte(byte, fault);
        labels.push(from_number(values[0]).map_err(in_row)?);
        samples.push(&values[1..], 2, in_row);
    }
    let recording = own(
        path,
        DataSet::OWN,
        samples.finish()?,
        labels.into_iter().collect(),
    )?;
    divided(recording, &AuxiliaryColumns::default())
}

/// Samples without labels, of a file that is asked for by its name.
pub(crate) fn unlabelled(path: &Path, samples: Vec<Sample>) -> Result<Vec<Recording>, Damage> {
    let truth = samples.iter().map(|_| Motion::Unknown).collect();
    let recording = own(path, DataSet::OWN, samples, truth)?;
    divided(recording, &AuxiliaryColumns::default())
}

/// Recording of a person whom the file alone does not name.
pub(crate) fn own(
    path: &Path,
    data_set: DataSet,
    samples: Vec<Sample>,
    truth: GroundTruth,
) -> Result<Recording, Damage> {
    if samples.is_empty() {
        return Err(Damage::of_file(Fault::Empty));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut notes = Vec::new();
    if data_set == DataSet::OWN && name.contains("movement") {
        notes.push("a movement trial: the reference trains on it but does not score it".to_owned());
    }
    if data_set == DataSet::OWN && left_arm(path) {
        notes.push(LEFT.to_owned());
    }
    Ok(Recording {
        data_set,
        subject: format!("{}/unknown", data_set.name()),
        name: name.into_owned(),
        path: path.to_owned(),
        samples,
        labels: truth.labels,
        notes,
        other_movement: truth.other_movement,
        timing: Timing::Cues,
        findings: Vec::new(),
        wearer: Normalizer::new(),
    })
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::readers::error::Place;
    use crate::readers::npy::Layout;
    use crate::recording::movement::{Movement, MovementKind};

    fn read_csv(path: &Path, text: &str) -> Result<Recording, Damage> {
        let columns =
            Columns::of(text).map_err(|error| Damage::at_line(error.line, error.fault))?;
        Ok(super::read_csv(path, text, &columns)?.remove(0))
    }

    #[test]
    fn columns_are_found_by_name_and_others_ignored() {
        let text = "time,gt,emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7,task\n\
                    0.1,2,1,2,3,4,5,6,7,-128,grasp\n0.2,-1,1,2,3,4,5,6,7,128.0,grasp\n";
        let recording = read_csv(Path::new("/d/s4/s4_grasp_movement.csv"), text).unwrap();
        assert_eq!(recording.labels, [Some(Intent::Close), None]);
        assert_eq!(
            recording.samples,
            [[1, 2, 3, 4, 5, 6, 7, -128], [1, 2, 3, 4, 5, 6, 7, 127]]
        );
        assert_eq!(recording.notes.len(), 1, "a movement trial");
    }

    #[test]
    fn other_movement_is_read_beside_the_labels() {
        let text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n\
                    0,1,2,3,4,5,6,7,8\n-2,1,2,3,4,5,6,7,8\nother,1,2,3,4,5,6,7,8\npoint,1,2,3,4,5,6,7,8\n";
        let recording = read_csv(Path::new("/d/anna/anna_1.csv"), text).unwrap();
        assert_eq!(recording.labels, [Some(Intent::Relax), None, None, None]);
        let other = Movement::new(MovementKind::Other, 1..3);
        let point = Movement::new(MovementKind::Point, 3..4);
        assert_eq!(recording.other_movement, [other, point]);
    }

    #[test]
    fn a_recorded_file_names_its_other_movement_in_a_column() {
        let read = |header: &str, name: &str| {
            let text = format!(
                "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7,sample,cue,trial,used,{header},movement\n\
                 -2,1,2,3,4,5,6,7,8,0,-2,1,1,0,{name}\n0,1,2,3,4,5,6,7,8,1,-2,1,1,0,point\n"
            );
            read_csv(Path::new("/d/anna/anna_1.csv"), &text)
        };
        let kind = |name| read("bridged", name).unwrap().other_movement[0].kind;
        assert_eq!(kind("thumb-up"), MovementKind::ThumbUp);
        assert_eq!(kind(""), MovementKind::Other);
        let damage = read("bridged", "fist").unwrap_err();
        assert_eq!(damage.place, Place::Line(2), "{damage:?}");
        // In other files the column may mean anything.
        let other = read("mine", "fist").unwrap();
        assert_eq!(other.other_movement[0].kind, MovementKind::Other);
    }

    #[test]
    fn channels_are_turned_as_the_board_was_aligned() {
        let header = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7,turn,mirrored\n";
        let read = |rows: &str| {
            let text = format!("{header}{rows}");
            read_csv(Path::new("/d/anna/anna_1.csv"), &text)
        };
        let rows = "0,0,1,2,3,4,5,6,7,0,0\n0,0,1,2,3,4,5,6,7,3,0\n0,0,1,2,3,4,5,6,7,3,1\n";
        let expected = [
            [0, 1, 2, 3, 4, 5, 6, 7],
            [3, 4, 5, 6, 7, 0, 1, 2],
            [3, 2, 1, 0, 7, 6, 5, 4],
        ];
        assert_eq!(read(rows).unwrap().samples, expected);
        for wrong in ["8,0", "-1,0", "0.5,0", "0,2"] {
            let fault = read(&format!("0,0,1,2,3,4,5,6,7,{wrong}\n"))
                .unwrap_err()
                .fault;
            assert!(
                matches!(fault, Fault::Placement { .. }),
                "{wrong}: {fault:?}"
            );
        }
    }

    #[test]
    fn faults_name_the_line() {
        let header = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n";
        let read = |rows: &str| read_csv(Path::new("/d/s1_a.csv"), &format!("{header}{rows}"));
        let label = read("0,0,0,0,0,0,0,0,0\n6,0,0,0,0,0,0,0,0\n").unwrap_err();
        assert_eq!(label.place, Place::Line(3));
        assert!(matches!(label.fault, Fault::Label { .. }));
        let short = read("0,0,0\n").unwrap_err();
        assert_eq!(
            short,
            Damage::at_line(
                2,
                Fault::Fields {
                    expected: 9,
                    found: 3
                }
            )
        );
        assert_eq!(read("").unwrap_err().fault, Fault::Empty);
    }

    #[test]
    fn npy_has_the_label_in_front() {
        let array = Array {
            shape: vec![1, 9],
            descr: "<f8".into(),
            values: Values::Numbers(vec![1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -7.0]),
            layout: Layout {
                start: 128,
                row_bytes: 72,
            },
        };
        let path = Path::new("/d/trainingJSON_user3/trainingSamples_idx_1_open.npy");
        assert!(is_recording(path, &array));
        assert!(is_recording(Path::new("/d/s3_grasp_1.npy"), &array));
        assert!(!is_recording(Path::new("/d/own.npy"), &array));
        let times = Array {
            values: Values::Numbers(vec![0.005; 9]),
            ..array.clone()
        };
        assert!(!is_recording(path, &times));
        let recording = &read_npy(path, &array).unwrap()[0];
        assert_eq!(recording.labels, [Some(Intent::Open)]);
        assert_eq!(recording.samples, [[0, 1, 2, 3, 4, 5, 6, -7]]);
    }
}
