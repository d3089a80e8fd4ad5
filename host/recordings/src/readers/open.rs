//! Recognition of one file's format, and the recordings in it.

mod rows;
#[cfg(test)]
mod tests;

use std::path::Path;

use super::error::{Damage, Fault, LoadError};
use super::npy::{self, Values};
use super::path::{ending, with_small_ending};
use crate::catalogue::DataSet;
use crate::description::own;
use crate::description::published::Layout;
use crate::examiner::wide;
use crate::recording::Recording;
use execution::file_kind::FileKind;

/// Content of one file.
pub enum Found {
    /// Recordings of a data set.
    Recordings(Vec<Recording>),
    /// Part of a recording whose samples are in another file.
    Part,
    /// No recording that is read, and why.
    Nothing(SkipReason),
}

shared::names! {
    /// Reason why a file is passed over without an error.
    #[derive(PartialOrd, Ord)]
    pub enum SkipReason {
        /// The ending is not that of recordings: licences, notes, settings.
        Ending = "no npy, csv, txt, dat, json or mat",
        /// The content is in none of the layouts.
        Layout = "in none of the layouts",
        /// Eight channels, but of no known set, and labels or person are unknown.
        UnknownSet = "eight channels, but of no known set and without labels: give such a file by itself",
        /// The data set is not wanted.
        NotWanted = "of a data set that is not asked for",
        /// It is another copy of what is read: untrimmed, or a copy of another person's file.
        Copy = "a copy of another file",
        /// A path that the description of its folder does not name.
        Pattern = "not named as `files` in recordings.toml says",
    }
}

/// Request for the recordings of one file.
#[derive(Clone, Copy)]
pub struct OpenRequest<'r> {
    /// Data sets that are wanted; all if empty.
    pub data_sets: &'r [DataSet],
    /// Whether it is the only file asked for: then any eight channels are read.
    pub alone: bool,
}

/// Reads one file if it is a recording of a data set that is wanted.
pub(crate) fn open(path: &Path, request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    // What only the name decides: headerless binary could be anything.
    if recording_ending(path).is_none() {
        return Ok(Found::Nothing(SkipReason::Ending));
    }
    of_bytes(path, &super::read(path)?, request)
}

/// The ending of a path that may be a recording, or one that is refused with what converts it.
fn recording_ending(path: &Path) -> Option<String> {
    ending(path).filter(|ending| {
        matches!(
            ending.as_str(),
            "npy" | "csv" | "txt" | "dat" | "json" | "mat" | "edf" | "bdf" | "xdf"
        )
    })
}

/// Reads one file from its bytes if it is a recording of a data set that is wanted; files beside it are read from the
/// folder of `path`.
pub fn of_bytes(path: &Path, bytes: &[u8], request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    let Some(ending) = recording_ending(path) else {
        return Ok(Found::Nothing(SkipReason::Ending));
    };
    let damage = |damage: Damage| damage.in_file(path);
    let kind = FileKind::of(bytes);
    match kind {
        FileKind::Empty => return Err(damage(Damage::of_file(Fault::Empty))),
        FileKind::LfsPointer
        | FileKind::Html
        | FileKind::Zip
        | FileKind::Gzip
        | FileKind::Edf
        | FileKind::Xdf
        | FileKind::Model => return Err(damage(Damage::of_kind(KINDS, kind))),
        _ => {}
    }
    if let Some((layout, fields)) = Layout::of(path, bytes) {
        if layout.is_copy(&fields) {
            return Ok(Found::Nothing(SkipReason::Copy));
        }
        return request.several(layout.set, || layout.read(path, bytes, &fields));
    }
    match ending.as_str() {
        _ if kind == FileKind::Npy => array(path, bytes, request),
        _ if with_small_ending(path).ends_with("userData.mat") => request
            .several(DataSet::named("epn"), || {
                Err(damage(Damage::of_file(Fault::Objects)))
            }),
        _ if kind == FileKind::Mat => request.nothing(path, kind),
        "npy" => Err(damage(Damage::of_kind("an npy array", kind))),
        "mat" => request.nothing(path, kind),
        _ => rows::open(path, bytes, request),
    }
}

/// Rows of an array that are looked at.
const FIRST: usize = 100;

/// Files that are accepted, in words.
const KINDS: &str = "a recording (csv, npy, mat, dat or json)";

impl OpenRequest<'_> {
    pub(crate) fn wants(&self, data_set: DataSet) -> bool {
        self.data_sets.is_empty() || self.data_sets.contains(&data_set)
    }

    fn several(
        &self,
        data_set: DataSet,
        read: impl FnOnce() -> Result<Vec<Recording>, LoadError>,
    ) -> Result<Found, LoadError> {
        if !self.wants(data_set) {
            return Ok(Found::Nothing(SkipReason::NotWanted));
        }
        let recordings = read()?;
        // What is left of a damaged file may be a valid file without samples.
        let empty = recordings.iter().find(|found| found.samples.is_empty());
        match empty {
            None => Ok(Found::Recordings(recordings)),
            Some(empty) => Err(Damage::of_file(Fault::Empty).in_file(&empty.path)),
        }
    }

    /// Passes over a file that is no recording; refuses it if it is the one that was asked for.
    fn nothing(&self, path: &Path, found: FileKind) -> Result<Found, LoadError> {
        if self.alone {
            Err(Damage::of_kind(KINDS, found).in_file(path))
        } else {
            Ok(Found::Nothing(SkipReason::Layout))
        }
    }

    /// Reads eight channels of no known set if the file was asked for by its name; else passes over it.
    fn unknown(
        &self,
        read: impl FnOnce() -> Result<Vec<Recording>, LoadError>,
    ) -> Result<Found, LoadError> {
        if self.alone {
            self.several(DataSet::OWN, read)
        } else {
            Ok(Found::Nothing(SkipReason::UnknownSet))
        }
    }
}

fn array(path: &Path, bytes: &[u8], request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    let array = npy::parse(bytes).map_err(damage)?;
    // Annotations, read with their samples.
    let is_text = matches!((&array.shape[..], &array.values), ([_], Values::Text(_)));
    if is_text || Layout::is_of_labels(path) {
        return Ok(Found::Part);
    }
    if own::is_recording(path, &array) {
        return request.several(DataSet::OWN, || own::array(path, &array));
    }
    if let ([_, .., _], Values::Numbers(values)) = (&array.shape[..], &array.values) {
        let columns = array.shape[1..]
            .iter()
            .fold(1, |all: usize, own| all.saturating_mul(*own));
        let rows = values.chunks_exact(columns.max(1)).take(FIRST);
        let rows: Vec<Vec<f64>> = rows.map(<[f64]>::to_vec).collect();
        wide::in_rows(columns, columns, &rows)
            .map_err(|finding| damage(Damage::refused(finding)))?;
    }
    match (&array.shape[..], &array.values) {
        ([_, 8], Values::Numbers(_)) => request.unknown(|| own::array(path, &array)),
        (shape, _) if request.alone || matches!(shape, [_, 9] | [8, _]) => {
            Err(damage(Damage::of_file(Fault::Array {
                expected: "eight channels of numbers, (n, 8); where a label or times are beside them, a csv with a \
                           header says so, gt,emg_0 to emg_7",
                found: array.describe(),
            })))
        }
        _ => Ok(Found::Nothing(SkipReason::Layout)),
    }
}
