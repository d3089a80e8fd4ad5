//! ReactEMG's preprocessed layout (ROAM-EMG and what the reference converts): csv with columns
//! `gt` and `emg_0`..`emg_7` (or `emg0`..`emg7`), or npy with the label first, then eight channels.
//!
//! The person is the folder's name where the file's starts with it (`s3/s3_grasp_1.csv`), or `s` and a number
//! in front of the file's; otherwise unknown, the same for all such files. Eight channels alone, without labels
//! and of no known set, are read where they are the only file asked for.
//!
//! Values are the armband's counts. Label -1 is unlabelled. Other csv columns are ignored, except
//! [`MUSCLE_COLUMN`], which marks synthetic recordings, [`RECORDER_COLUMNS`], which mark labels of the muscle, and [`TURN_COLUMN`] with [`MIRRORED_COLUMN`]: the channels are turned as
//! a board turns them that was aligned so.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::alignment::Alignment;
use shared::stream::normalizer::Normalizer;
use shared::units::{CHANNELS, Sample};

use crate::dataset::readers::error::{Damage, Fault};
use crate::dataset::readers::labels::from_number;
use crate::dataset::readers::npy::{Array, Values};
use crate::dataset::readers::path::{folder, is_number, stem};
use crate::dataset::readers::table;
use crate::dataset::recording::{DataSet, Recording, Timing};

/// Column that synthetic recordings have besides: the intent that the muscle follows, class number.
pub(crate) const MUSCLE_COLUMN: &str = "synthetic_muscle";

/// Column of recordings by `myointent record`: places that the armband is turned by, as the board was aligned.
pub(crate) const TURN_COLUMN: &str = "turn";

/// The same: 1 if it is on the other arm.
pub(crate) const MIRRORED_COLUMN: &str = "mirrored";

/// Columns that `myointent record` writes behind the channels. The labels beside them are the muscle's.
pub(crate) const RECORDER_COLUMNS: [&str; 5] = ["sample", "cue", "trial", "used", "bridged"];

/// Note of a recording of an unknown person.
const UNNAMED: &str =
    "whose recording this is is not known: expected a path like s3/s3_grasp_1.csv";

/// Where the columns are.
struct Columns {
    label: usize,
    channels: [usize; CHANNELS],
    synthetic: bool,
    timing: Timing,
    /// Of the turn and of whether it is mirrored.
    placement: Option<[usize; 2]>,
    count: usize,
}

impl Columns {
    fn find(header: &str) -> Option<Self> {
        let names: Vec<&str> = header.trim_end().split(',').map(str::trim).collect();
        let position = |name: &str| names.iter().position(|n| *n == name);
        let mut channels = [0; CHANNELS];
        for (channel, column) in channels.iter_mut().enumerate() {
            *column = position(&format!("emg_{channel}"))
                .or_else(|| position(&format!("emg{channel}")))?;
        }
        Some(Self {
            label: position("gt")?,
            channels,
            synthetic: position(MUSCLE_COLUMN).is_some(),
            timing: if RECORDER_COLUMNS.map(position).iter().all(Option::is_some) {
                Timing::Muscle
            } else {
                Timing::Cues
            },
            placement: position(TURN_COLUMN)
                .zip(position(MIRRORED_COLUMN))
                .map(Into::into),
            count: names.len(),
        })
    }
}

/// Whether a text starts with the layout's header.
pub(crate) fn has_header(text: &str) -> bool {
    text.lines()
        .next()
        .is_some_and(|header| Columns::find(header).is_some())
}

pub(crate) fn read_csv(path: &Path, text: &str) -> Result<Recording, Damage> {
    let mut rows = table::rows(text);
    let columns = rows.next().and_then(|(_, header)| Columns::find(header));
    let columns = columns.ok_or_else(|| Damage::at_line(1, Fault::Empty))?;
    let (mut samples, mut labels) = (Vec::new(), Vec::new());
    for (line, row) in rows {
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != columns.count {
            let fault = Fault::Fields {
                expected: columns.count,
                found: fields.len(),
            };
            return Err(Damage::at_line(line, fault));
        }
        let number = |column: usize| table::number(line, column + 1, fields[column]);
        let mut counts = [0.0; CHANNELS];
        for (count, &column) in counts.iter_mut().zip(&columns.channels) {
            *count = number(column)?;
        }
        let at_line = |fault| Damage::at_line(line, fault);
        let sample = table::sample(&counts, columns.channels[0] + 1).map_err(at_line)?;
        let placement = match columns.placement {
            None => Alignment::NONE,
            Some([turn, mirrored]) => {
                let (turn, mirrored) = (number(turn)?, number(mirrored)?);
                placement(turn, mirrored)
                    .ok_or_else(|| at_line(Fault::Placement { turn, mirrored }))?
            }
        };
        samples.push(placement.apply(sample));
        labels.push(from_number(number(columns.label)?).map_err(at_line)?);
    }
    let data_set = if columns.synthetic {
        DataSet::Synthetic
    } else {
        DataSet::ReactEmg
    };
    Ok(Recording {
        timing: columns.timing,
        ..recording(path, data_set, samples, labels)?
    })
}

/// One of the 16 placements.
fn placement(turn: f64, mirrored: f64) -> Option<Alignment> {
    let places = 0..CHANNELS as u8;
    let turn = places.into_iter().find(|&place| f64::from(place) == turn)?;
    let mirrored = [0.0, 1.0].iter().position(|&known| known == mirrored)?;
    Some(Alignment::new(turn, mirrored == 1))
}

/// Whether an array has the layout's shape, label and eight channels, and labels in most of its first rows.
pub(crate) fn is_recording(array: &Array) -> bool {
    const EXAMINED: usize = 20;
    let (Values::Numbers(values), &[_, COLUMNS]) = (&array.values, &array.shape[..]) else {
        return false;
    };
    let rows = values.chunks_exact(COLUMNS).take(EXAMINED);
    let labelled = rows.clone().filter(|row| from_number(row[0]).is_ok());
    2 * labelled.count() > rows.len()
}

/// Label and channels.
const COLUMNS: usize = CHANNELS + 1;

/// Reads (n, 9): label and channels.
pub(crate) fn read_npy(path: &Path, array: &Array) -> Result<Recording, Damage> {
    let (Values::Numbers(values), &[_, COLUMNS]) = (&array.values, &array.shape[..]) else {
        return Err(Damage::of_file(Fault::Array {
            expected: "numbers, (n, 9)",
            found: array.describe(),
        }));
    };
    let (mut samples, mut labels) = (Vec::new(), Vec::new());
    for (row, values) in values.chunks_exact(COLUMNS).enumerate() {
        let byte = array.byte_of_row(row);
        let in_row = |fault| Damage::at_byte(byte, fault);
        labels.push(from_number(values[0]).map_err(in_row)?);
        samples.push(table::sample(&values[1..], 2).map_err(in_row)?);
    }
    recording(path, DataSet::ReactEmg, samples, labels)
}

/// Samples without labels, of a file that is asked for by its name.
pub(crate) fn unlabelled(path: &Path, samples: Vec<Sample>) -> Result<Recording, Damage> {
    let labels = vec![None; samples.len()];
    recording(path, DataSet::ReactEmg, samples, labels)
}

/// The person that a path names.
fn person(path: &Path) -> Option<&str> {
    let name = stem(path)?;
    let folder = folder(path, 1);
    // EMG-EPN-612, converted, has one folder a person and no person in the name.
    if name.starts_with("trainingSamples") || name.starts_with("testingSamples") {
        return folder;
    }
    let (first, _) = name.split_once('_')?;
    let numbered = first.strip_prefix(['s', 'S']).is_some_and(is_number);
    (numbered || folder == Some(first)).then_some(first)
}

fn recording(
    path: &Path,
    data_set: DataSet,
    samples: Vec<Sample>,
    labels: Vec<Option<Intent>>,
) -> Result<Recording, Damage> {
    if samples.is_empty() {
        return Err(Damage::of_file(Fault::Empty));
    }
    let misplaced = || Damage::of_file(Fault::Path("s3/s3_grasp_1.csv"));
    let name = stem(path).ok_or_else(misplaced)?;
    let person = person(path);
    let mut notes = Vec::new();
    if data_set == DataSet::ReactEmg && name.contains("movement") {
        notes.push("a movement trial: the reference trains on it but does not score it".to_owned());
    }
    if person.is_none() {
        notes.push(UNNAMED.to_owned());
    }
    Ok(Recording {
        data_set,
        subject: format!("{}/{}", data_set.name(), person.unwrap_or("unknown")),
        name: name.to_owned(),
        path: path.to_owned(),
        samples,
        labels,
        notes,
        other_movement: Vec::new(),
        timing: Timing::Cues,
        wearer: Normalizer::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::readers::error::Place;
    use crate::dataset::readers::npy::Layout;

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
        assert_eq!(
            (recording.subject.as_str(), recording.notes.len()),
            ("react-emg/s4", 1)
        );
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
        assert!(is_recording(&array));
        let times = Array {
            values: Values::Numbers(vec![0.005; 9]),
            ..array.clone()
        };
        assert!(!is_recording(&times));
        let recording = read_npy(
            Path::new("/d/trainingJSON_user3/trainingSamples_idx_1_open.npy"),
            &array,
        );
        let recording = recording.unwrap();
        assert_eq!(recording.labels, [Some(Intent::Open)]);
        assert_eq!(recording.samples, [[0, 1, 2, 3, 4, 5, 6, -7]]);
        assert_eq!(recording.subject, "react-emg/trainingJSON_user3");
    }
}
