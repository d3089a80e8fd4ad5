//! Finds recordings below a path and reads each by what its file looks like.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::{Damage, Fault, LoadError, Remedy};
use super::{
    DataSet, Recording, cote_allard, emg_epn, myo_readings, npy, one_subject_myo, react_emg,
    roshambo, ss_stm, table,
};

/// How to treat what is found.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadOptions {
    /// Stop at the first damaged file, rather than leave damaged files out and list them.
    pub strict: bool,
    /// Data sets to read, files of others are passed over; all if empty.
    pub data_sets: Vec<DataSet>,
}

impl LoadOptions {
    fn wants(&self, data_set: DataSet) -> bool {
        self.data_sets.is_empty() || self.data_sets.contains(&data_set)
    }
}

/// Everything found below one path.
#[derive(Debug, Default)]
pub struct Library {
    /// The recordings, ordered by path.
    pub recordings: Vec<Recording>,
    /// Damaged files that were left out, unless [`LoadOptions::strict`].
    pub skipped: Vec<Skipped>,
    /// Recordings left out because another holds the same samples.
    pub repeats: Vec<Repeat>,
    /// Files that are no recordings (licences, notes, settings).
    pub ignored: Vec<PathBuf>,
}

/// A damaged file that was left out.
#[derive(Debug)]
pub struct Skipped {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it, and where.
    pub error: LoadError,
}

/// A recording left out because its samples are published twice.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Repeat {
    /// The file left out.
    pub path: PathBuf,
    /// The file kept.
    pub kept: PathBuf,
}

/// What one file turned out to be.
enum Found {
    Recordings(Vec<Recording>),
    /// Belongs to a recording that another file begins.
    Part,
    Nothing,
}

/// Reads every recording at or below a path: a folder of many sets, one set, or one file.
///
/// # Errors
/// [`LoadError::Damaged`] at the first damaged file in path order with
/// [`LoadOptions::strict`]; [`LoadError::NoRecordings`] if none is found;
/// [`LoadError::Io`] if the file system refuses.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Library, LoadError> {
    let files = files(path)?;
    let found: Vec<_> = files.par_iter().map(|file| open(file, options)).collect();
    let mut library = Library::default();
    for (file, found) in files.into_iter().zip(found) {
        match found {
            Ok(Found::Recordings(recordings)) => library.recordings.extend(recordings),
            Ok(Found::Part) => {}
            Ok(Found::Nothing) => library.ignored.push(file),
            Err(error @ LoadError::Damaged { .. }) if !options.strict => {
                library.skipped.push(Skipped { path: file, error });
            }
            Err(error) => return Err(error),
        }
    }
    if library.recordings.is_empty() && library.skipped.is_empty() {
        return Err(LoadError::NoRecordings {
            path: path.to_owned(),
        });
    }
    library.leave_out_repeats();
    Ok(library)
}

impl Library {
    /// Subjects, each once, in alphabetical order.
    #[must_use]
    pub fn subjects(&self) -> Vec<String> {
        let mut subjects: Vec<_> = self.recordings.iter().map(|r| r.subject.clone()).collect();
        subjects.sort_unstable();
        subjects.dedup();
        subjects
    }

    /// Leaves out copies of a recording under another subject's name.
    ///
    /// `cote-allard` publishes one evaluation subject again as three pre-training subjects: kept
    /// once, or the same person would be trained on and held out. The evaluation part, first in
    /// path order, is what stays.
    fn leave_out_repeats(&mut self) {
        let mut seen: HashMap<Vec<shared::units::Sample>, (String, PathBuf)> = HashMap::new();
        let repeats = &mut self.repeats;
        self.recordings.retain(|recording| {
            if recording.data_set != DataSet::CoteAllard {
                return true;
            }
            let first = seen
                .entry(recording.samples.clone())
                .or_insert_with(|| (recording.subject.clone(), recording.path.clone()));
            let keep = first.0 == recording.subject;
            if !keep {
                repeats.push(Repeat {
                    path: recording.path.clone(),
                    kept: first.1.clone(),
                });
            }
            keep
        });
    }
}

/// The error of a damaged file.
pub(super) fn damaged(path: &Path, damage: Damage) -> LoadError {
    LoadError::Damaged {
        path: path.to_owned(),
        place: damage.place,
        fault: damage.fault,
        remedy: if myo_readings::is_damaged_as_published(path) {
            Remedy::SkipAsPublished
        } else {
            Remedy::MendOrSkip
        },
    }
}

/// Name of the folder `levels` above the file: 1 is the folder it lies in.
pub(super) fn folder_name(path: &Path, levels: usize) -> Option<&str> {
    path.ancestors().nth(levels)?.file_name()?.to_str()
}

/// Files at or below a path, absolute so that folder names are known, in path order.
fn files(path: &Path) -> Result<Vec<PathBuf>, LoadError> {
    let refused = |source| LoadError::Io {
        path: path.to_owned(),
        source,
    };
    let root = path.canonicalize().map_err(refused)?;
    let mut files = Vec::new();
    for entry in walkdir::WalkDir::new(root)
        .follow_links(true)
        .sort_by_file_name()
    {
        let entry = entry.map_err(|error| refused(error.into()))?;
        if entry.file_type().is_file() {
            files.push(entry.into_path());
        }
    }
    Ok(files)
}

fn open(path: &Path, options: &LoadOptions) -> Result<Found, LoadError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    // The only question the name answers alone: headerless binary looks like anything.
    if !matches!(extension, "npy" | "csv" | "txt" | "dat" | "json") {
        return Ok(Found::Nothing);
    }
    let bytes = std::fs::read(path).map_err(|source| LoadError::Io {
        path: path.to_owned(),
        source,
    })?;
    if bytes.is_empty() {
        return Err(damaged(path, Damage::of_file(Fault::Empty)));
    }
    let one = |recording: Result<Recording, Damage>| {
        recording
            .map(|r| Found::Recordings(vec![r]))
            .map_err(|damage| damaged(path, damage))
    };
    if extension == "dat" {
        if !options.wants(DataSet::CoteAllard) {
            return Ok(Found::Nothing);
        }
        return one(cote_allard::read(path, &bytes));
    }
    if extension == "npy" || npy::looks_like(&bytes) {
        return npy(path, &bytes, options);
    }
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Ok(Found::Nothing);
    };
    if extension == "json" {
        if !options.wants(DataSet::EmgEpn612) || !emg_epn::looks_like(text) {
            return Ok(Found::Nothing);
        }
        let user = emg_epn::read(path, text).map_err(|damage| damaged(path, damage))?;
        return Ok(Found::Recordings(user));
    }
    let layout = Layout::of(text).filter(|layout| options.wants(layout.data_set()));
    match layout {
        Some(Layout::ReactEmg) => one(react_emg::read_csv(path, text)),
        Some(Layout::MyoReadings) => one(myo_readings::read(path, text)),
        Some(Layout::SsStm) => one(ss_stm::read(path, text)),
        Some(Layout::OneSubjectMyo) => {
            let metadata = std::fs::read_to_string(path.with_file_name("metadata.json")).ok();
            one(one_subject_myo::read(path, text, metadata.as_deref()))
        }
        None => Ok(Found::Nothing),
    }
}

fn npy(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Found, LoadError> {
    let array = npy::parse(bytes).map_err(|damage| damaged(path, damage))?;
    let recording = match (&array.shape[..], &array.values) {
        // Annotations of `roshambo`, read with their samples.
        ([_], npy::Values::Text(_)) => return Ok(Found::Part),
        _ if roshambo::is_samples(path, &array) => {
            if !options.wants(DataSet::Roshambo) {
                return Ok(Found::Nothing);
            }
            roshambo::read(path, &array)?
        }
        _ if options.wants(DataSet::ReactEmg) && react_emg::is_recording(&array) => {
            react_emg::read_npy(path, &array).map_err(|damage| damaged(path, damage))?
        }
        _ => return Ok(Found::Nothing),
    };
    Ok(Found::Recordings(vec![recording]))
}

/// Layouts of the text formats.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Layout {
    ReactEmg,
    MyoReadings,
    SsStm,
    OneSubjectMyo,
}

/// Rows that are looked at: one damaged row among them must not hide what the file is.
const LOOKED_AT: usize = 20;

impl Layout {
    /// The data set that is published in this layout.
    const fn data_set(self) -> DataSet {
        match self {
            Self::ReactEmg => DataSet::ReactEmg,
            Self::MyoReadings => DataSet::MyoReadings,
            Self::SsStm => DataSet::SsStm,
            Self::OneSubjectMyo => DataSet::OneSubjectMyo,
        }
    }

    /// Tells the formats apart by the header, or by how many values a row has, whole or decimal.
    fn of(text: &str) -> Option<Self> {
        if react_emg::has_header(text) {
            return Some(Self::ReactEmg);
        }
        let rows: Vec<_> = table::rows(text).take(LOOKED_AT).collect();
        let most = |count: usize| 2 * count > rows.len();
        let nine = rows
            .iter()
            .filter(|(line, row)| table::numbers::<9>(*line, row).is_ok());
        if most(nine.count()) {
            return Some(Self::MyoReadings);
        }
        let eight: Vec<_> = rows
            .iter()
            .filter_map(|(line, row)| table::numbers::<8>(*line, row).ok())
            .collect();
        if !most(eight.len()) {
            return None;
        }
        let decimal = |row: &&[f64; 8]| {
            row.iter().all(|value| value.abs() <= 1.0) && row.iter().any(|v| v.fract() != 0.0)
        };
        let decimals = eight.iter().filter(decimal).count();
        Some(if most(decimals) {
            Self::SsStm
        } else {
            Self::OneSubjectMyo
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_formats_are_told_apart_by_their_rows() {
        let header = "gt,emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7\n0,0,0,0,0,0,0,0,0\n";
        assert_eq!(Layout::of(header), Some(Layout::ReactEmg));
        assert_eq!(Layout::of("1,2,3,4,5,6,7,8,0\n"), Some(Layout::MyoReadings));
        assert_eq!(Layout::of("-0.5,0,0,0,0,0,1,-1\n"), Some(Layout::SsStm));
        assert_eq!(
            Layout::of("1,2,3,4,5,6,7,8\r\n"),
            Some(Layout::OneSubjectMyo)
        );
        assert_eq!(Layout::of("Sex,M,,\nAge,24,,\n"), None);
        assert_eq!(Layout::of(""), None);
    }

    #[test]
    fn a_damaged_first_row_does_not_hide_the_format() {
        let text = format!("1,2,3,4\n{}", "1,2,3,4,5,6,7,8,0\n".repeat(9));
        assert_eq!(Layout::of(&text), Some(Layout::MyoReadings));
    }

    #[test]
    fn a_path_without_recordings_says_so() {
        let folder = std::env::temp_dir().join(format!("myointent-empty-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("notes.txt"), "not a recording\n").unwrap();
        let error = load(&folder, &LoadOptions::default()).unwrap_err();
        assert!(matches!(error, LoadError::NoRecordings { .. }));
        let missing = load(&folder.join("nowhere"), &LoadOptions::default()).unwrap_err();
        assert!(matches!(missing, LoadError::Io { .. }));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_damaged_file_stops_the_load_or_is_listed() {
        let folder = std::env::temp_dir().join(format!("myointent-bad-{}", std::process::id()));
        let sitting = folder.join("12345-1");
        std::fs::create_dir_all(&sitting).unwrap();
        let good = "1,2,3,4,5,6,7,8,0\n".repeat(30);
        std::fs::write(sitting.join("0.txt"), &good).unwrap();
        std::fs::write(sitting.join("7.txt"), format!("{good}1,2\n")).unwrap();
        let error = load(&folder, &LoadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("7.txt, line 31: expected 9") && error.contains("--skip-bad"),
            "{error}"
        );
        let library = load(&folder, &LoadOptions::default()).unwrap();
        assert_eq!((library.recordings.len(), library.skipped.len()), (1, 1));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_recording_published_twice_is_kept_once() {
        let folder = std::env::temp_dir().join(format!("myointent-twice-{}", std::process::id()));
        let mut bytes = vec![0; 1600];
        bytes[0] = 5;
        for person in [
            "EvaluationDataset/Female0/Test0",
            "PreTrainingDataset/Female8/training0",
        ] {
            std::fs::create_dir_all(folder.join(person)).unwrap();
            std::fs::write(folder.join(person).join("classe_0.dat"), &bytes).unwrap();
        }
        let library = load(&folder, &LoadOptions::default()).unwrap();
        assert_eq!(library.subjects(), ["cote-allard/E-Female0"]);
        assert!(
            library.repeats[0]
                .path
                .ends_with("Female8/training0/classe_0.dat")
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
