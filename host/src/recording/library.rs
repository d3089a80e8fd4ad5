//! Finds recordings below a path and reads each by what its file looks like.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::{Damage, Fault, LoadError};
use super::{DataSet, Recording, cote_allard, myo_readings, numpy, roshambo, ss_stm, table};

/// How to treat what is found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct LoadOptions {
    /// Leave damaged files out and list them, rather than stop at the first.
    pub skip_bad: bool,
}

/// Everything found below one path.
#[derive(Debug, Default)]
pub struct Library {
    /// The recordings, ordered by path.
    pub recordings: Vec<Recording>,
    /// Damaged files that were left out, only with [`LoadOptions::skip_bad`].
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
/// [`LoadError::Damaged`] at the first damaged file in path order unless
/// [`LoadOptions::skip_bad`]; [`LoadError::NoRecordings`] if none is found;
/// [`LoadError::Io`] if the file system refuses.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Library, LoadError> {
    let files = files(path)?;
    let found: Vec<_> = files.par_iter().map(|file| open(file)).collect();
    let mut library = Library::default();
    for (file, found) in files.into_iter().zip(found) {
        match found {
            Ok(Found::Recordings(recordings)) => library.recordings.extend(recordings),
            Ok(Found::Part) => {}
            Ok(Found::Nothing) => library.ignored.push(file),
            Err(error @ LoadError::Damaged { .. }) if options.skip_bad => {
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
        published: myo_readings::is_damaged_as_published(path),
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

fn open(path: &Path) -> Result<Found, LoadError> {
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
        return one(cote_allard::read(path, &bytes));
    }
    if extension == "npy" || numpy::looks_like(&bytes) {
        return npy(path, &bytes);
    }
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Ok(Found::Nothing);
    };
    match layout(path, text) {
        Some(Layout::SsStm) => one(ss_stm::read(path, text)),
        Some(Layout::MyoReadings) => one(myo_readings::read(path, text)),
        None => Ok(Found::Nothing),
    }
}

fn npy(path: &Path, bytes: &[u8]) -> Result<Found, LoadError> {
    let array = numpy::parse(bytes).map_err(|damage| damaged(path, damage))?;
    if roshambo::is_samples(&array) {
        return Ok(Found::Recordings(vec![roshambo::read(path, &array)?]));
    }
    match (array.shape.as_slice(), &array.values) {
        ([_], numpy::Values::Text(_)) => Ok(Found::Part),
        _ => Ok(Found::Nothing),
    }
}

/// Layouts of the text formats.
enum Layout {
    SsStm,
    MyoReadings,
}

/// Rows that are looked at: one damaged row among them must not hide what the file is.
const LOOKED_AT: usize = 20;

/// Tells the text formats apart by their first rows: how many values, whole or decimal.
fn layout(_path: &Path, text: &str) -> Option<Layout> {
    let rows: Vec<_> = table::rows(text).take(LOOKED_AT).collect();
    let most = |count: usize| 2 * count > rows.len();
    let whole = rows
        .iter()
        .filter(|(line, row)| table::numbers::<9>(*line, row).is_ok())
        .count();
    if most(whole) {
        return Some(Layout::MyoReadings);
    }
    let eight: Vec<_> = rows
        .iter()
        .filter_map(|(line, row)| table::numbers::<8>(*line, row).ok())
        .collect();
    let small = eight.iter().flatten().all(|value| value.abs() <= 1.0);
    let decimal = eight.iter().flatten().any(|value| value.fract() != 0.0);
    (most(eight.len()) && small && decimal).then_some(Layout::SsStm)
}
