//! Recordings of the wearer's own that need no description, and ReactEMG's (ROAM-EMG and what the reference converts): a
//! table whose columns are known by their names, `gt` and `emg_0`..`emg_7` in ReactEMG's, or npy with the label first,
//! then eight channels, under ReactEMG's names of files.
//!
//! The folder names the person, once all files are known (`library/people.rs`). Values are the armband's counts. Label
//! -1 is unlabelled, -2 other movement. Columns besides channels and label are ignored, with four exceptions. [`MUSCLE_COLUMN`] marks
//! synthetic recordings. [`RECORDER_COLUMNS`] mark labels of the muscle, and beside them [`MOVEMENT_COLUMN`] names other
//! movement. By [`TURN_COLUMN`] and [`MIRRORED_COLUMN`] the channels are turned as by an aligned board.

use std::path::Path;
use std::sync::LazyLock;

use execution::printable::printable;
use shared::stream::alignment::Alignment;
use shared::units::CHANNELS;

use super::Description;
use super::rows::Rows;
use super::words::Words;
use crate::catalogue::DataSet;
use crate::examiner::finding::Finding;
use crate::labels::motion::Motion;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{Damage, LoadError};
use crate::readers::label_file::{from_number, from_text};
use crate::readers::npy::{Array, Values};
use crate::readers::path::{is_number, left_arm, stem};
use crate::readers::table;
use crate::readers::table::columns::Columns;
use crate::readers::table::one_hot;
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

/// Description of a table whose columns are known by their names, and of an array of eight channels.
static TABLE: LazyLock<Description> = LazyLock::new(|| parsed(""));

/// Description of an array of a label and eight channels.
static ARRAY: LazyLock<Description> =
    LazyLock::new(|| parsed("label = 1\nchannels = [2, 3, 4, 5, 6, 7, 8, 9]"));

fn parsed(columns: &str) -> Description {
    let text = format!("files = \"{{any}}\"\nrate = 200\n{columns}");
    toml::from_str(&text).expect("a test reads it")
}

/// Reads a table of these columns, sample by sample.
pub(crate) fn table(
    path: &Path,
    text: &str,
    columns: &Columns,
) -> Result<Vec<Recording>, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    let has = |name: &&str| columns.position(name).is_some();
    let is_recorded = RECORDER_COLUMNS.iter().all(has);
    let mut rows = TABLE.table(text, columns).map_err(damage)?;
    place(&mut rows, text, columns).map_err(damage)?;
    let movement = columns.position(MOVEMENT_COLUMN).filter(|_| is_recorded);
    if let (Some(label), Some(movement)) = (columns.label, movement) {
        let both = columns
            .texts(text, label)
            .zip(columns.texts(text, movement));
        let words = both.map(|(label, name)| {
            let is_named = !name.is_empty() && from_text(label) == Ok(Motion::OTHER);
            if is_named { name } else { label }
        });
        rows.labels.words = Some(words.collect());
    }
    let (mut notes, mut unread) = (Vec::new(), None);
    match one_hot::find(text, columns) {
        Some(one_hot::Found::Labels(motions, note)) => {
            rows.labels.words = Some(motions.into_iter().map(Motion::name).collect());
            notes.push(printable(&note));
        }
        Some(one_hot::Found::Unread(why)) => unread = Some(Finding::known(why)),
        None => {}
    }
    let label = columns.label.and_then(|column| columns.names.get(column));
    let is_number = |(word, _): &(String, usize)| word.parse::<f64>().is_ok();
    let mut words = rows.labels.words.iter().flat_map(Words::distinct);
    let has_numbers = words.any(is_number);
    if let Some(label) = label.filter(|label| has_numbers && *label != "gt") {
        notes.push(format!(
            "numbers in column {} are read as 0 relax, 1 open, 2 close, 3 wave-in, 4 wave-out, 5 pinch, -1 unknown, -2 other",
            excerpt(label)
        ));
    }
    let data_set = if has(&MUSCLE_COLUMN) {
        DataSet::SYNTHETIC
    } else {
        DataSet::OWN
    };
    let mut pieces = named(data_set, path, rows, &TABLE)?;
    if let (Some(first), Some(unread)) = (pieces.first_mut(), unread) {
        first.findings.insert(0, unread);
    }
    for piece in &mut pieces {
        piece.notes.extend_from_slice(&notes);
        if is_recorded {
            piece.timing = Timing::Muscle;
        }
    }
    Ok(pieces)
}

/// Rearranges the channels of rows as the columns of a board's alignment say.
fn place(rows: &mut Rows, text: &str, columns: &Columns) -> Result<(), Damage> {
    let both = [TURN_COLUMN, MIRRORED_COLUMN].map(|name| columns.position(name));
    let [Some(turns), Some(mirrored)] = both else {
        return Ok(());
    };
    let samples = rows.samples.iter_mut().enumerate();
    for ((row, sample), line) in samples.zip(columns.rows(text)) {
        let (_, fields) = line?;
        let number = |at: usize| table::number(at + 1, &columns.separator.number(fields[at]));
        let placement = number(turns).and_then(|turn| {
            let mirrored = number(mirrored)?;
            placement(turn, mirrored).ok_or_else(|| {
                format!("expected a turn of 0..=7 and mirrored 0 or 1, found {turn} and {mirrored}")
            })
        });
        let placement = placement.map_err(|fault| Damage::at(rows.labels.at.place(row), fault))?;
        *sample = placement.apply(*sample);
    }
    Ok(())
}

/// Recordings of the rows, of a person whom the file alone does not name.
fn named(
    data_set: DataSet,
    path: &Path,
    rows: Rows,
    description: &Description,
) -> Result<Vec<Recording>, LoadError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut notes = Vec::new();
    if data_set == DataSet::OWN && name.contains("movement") {
        notes.push("a movement trial: the reference trains on it but does not score it".to_owned());
    }
    if data_set == DataSet::OWN && left_arm(path) {
        notes.push(LEFT.to_owned());
    }
    let pieces = rows.recordings(description, path, None)?.into_iter();
    let whole = |piece: Recording| Recording {
        data_set,
        subject: format!("{}/unknown", data_set.name()),
        name: format!("{name}{}", piece.name),
        notes: notes.clone(),
        ..piece
    };
    Ok(pieces.map(whole).collect())
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

/// Reads an array: label and channels under ReactEMG's names, or eight channels of a file that is asked for by its name.
pub(crate) fn array(path: &Path, array: &Array) -> Result<Vec<Recording>, LoadError> {
    let description = if is_recording(path, array) {
        &ARRAY
    } else {
        &TABLE
    };
    let rows = description.array(array);
    let rows = rows.map_err(|damage| damage.in_file(path))?;
    named(DataSet::OWN, path, rows, description)
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::fixture::HEADER;
    use crate::readers::error::Place;
    use crate::readers::npy;
    use crate::recording::movement::MovementKind;

    fn read_csv(name: &str, text: &str) -> Result<Recording, Damage> {
        let columns = Columns::of(text).map_err(|error| error.damage)?;
        match table(&Path::new("/d/anna").join(name), text, &columns) {
            Ok(mut pieces) => Ok(pieces.remove(0)),
            Err(LoadError::Damaged { damage, .. }) => Err(damage),
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn columns_are_found_by_name_and_others_ignored() {
        let text = "time,gt,emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7,task\n\
                    0.1,2,1,2,3,4,5,6,7,-128,grasp\n0.2,-1,1,2,3,4,5,6,7,128.0,grasp\n";
        let recording = read_csv("s4_grasp_movement.csv", text).unwrap();
        assert_eq!(recording.labels, [Some(Intent::Close), None]);
        let samples = [[1, 2, 3, 4, 5, 6, 7, -128], [1, 2, 3, 4, 5, 6, 7, 127]];
        assert_eq!(recording.samples, samples);
        assert_eq!(recording.notes.len(), 1, "a movement trial");
    }

    #[test]
    fn a_recorded_file_names_its_other_movement_in_a_column() {
        let read = |header: &str, name: &str| {
            let text = format!(
                "{},sample,cue,trial,used,{header},movement\n\
                 -2,1,2,3,4,5,6,7,8,0,-2,1,1,0,{name}\n0,1,2,3,4,5,6,7,8,1,-2,1,1,0,point\n",
                HEADER.trim_end()
            );
            read_csv("anna_1.csv", &text)
        };
        // In files of other programs the column may mean anything.
        for (header, name, kind) in [
            ("bridged", "thumb-up", MovementKind::ThumbUp),
            ("bridged", "", MovementKind::Other),
            ("mine", "fist", MovementKind::Other),
        ] {
            let recording = read(header, name).unwrap();
            assert_eq!(recording.other_movement[0].kind, kind, "{header} {name}");
        }
        let damage = read("bridged", "fist").unwrap_err();
        assert_eq!(damage.place, Place::Line(2), "{damage:?}");
    }

    #[test]
    fn channels_are_turned_as_the_board_was_aligned() {
        let read = |placements: &[&str]| {
            let row = |placement: &&str| format!("0,0,1,2,3,4,5,6,7,{placement}\n");
            let rows: String = placements.iter().map(row).collect();
            let head = HEADER.replace('\n', ",turn,mirrored\n");
            read_csv("anna_1.csv", &(head + &rows))
        };
        let expected = [
            [0, 1, 2, 3, 4, 5, 6, 7],
            [3, 4, 5, 6, 7, 0, 1, 2],
            [3, 2, 1, 0, 7, 6, 5, 4],
        ];
        assert_eq!(read(&["0,0", "3,0", "3,1"]).unwrap().samples, expected);
        for wrong in ["8,0", "-1,0", "0.5,0", "0,2"] {
            let fault = read(&[wrong]).unwrap_err().fault;
            assert!(fault.starts_with("expected a turn of 0..=7 and"), "{fault}");
        }
    }

    #[test]
    fn npy_has_the_label_in_front() {
        let array = |values: [f64; 9]| {
            let bytes = values.map(f64::to_le_bytes).concat();
            npy::parse(&npy::encode("<f8", &[1, 9], &bytes)).unwrap()
        };
        let labelled = array([1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -7.0]);
        let path = Path::new("/d/trainingJSON_user3/trainingSamples_idx_1_open.npy");
        assert!(is_recording(path, &labelled));
        assert!(is_recording(Path::new("/d/s3_grasp_1.npy"), &labelled));
        assert!(!is_recording(Path::new("/d/own.npy"), &labelled));
        let times = array([0.005; 9]);
        assert!(!is_recording(path, &times));
        let recording = &super::array(path, &labelled).unwrap()[0];
        assert_eq!(recording.labels, [Some(Intent::Open)]);
        assert_eq!(recording.samples, [[0, 1, 2, 3, 4, 5, 6, -7]]);
    }
}
