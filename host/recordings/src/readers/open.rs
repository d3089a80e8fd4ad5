//! Recognition of one file's format, and the recordings in it.

#[cfg(test)]
mod tests;

use std::path::Path;

use super::error::{self, Damage, EMPTY, LoadError};
use super::libemg;
use super::npy::{self, Values};
use super::path::{ending, with_small_ending};
use super::table::columns::Columns;
use crate::catalogue::DataSet;
use crate::description::published::{PublishedFile, has_labels};
use crate::description::{own, repetitions};
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
        FileKind::Empty => return Err(damage(Damage::of_file(EMPTY))),
        FileKind::LfsPointer
        | FileKind::Html
        | FileKind::Zip
        | FileKind::Gzip
        | FileKind::Tar
        | FileKind::Edf
        | FileKind::Xdf
        | FileKind::Model => return Err(damage(Damage::of_kind(KINDS, kind))),
        _ => {}
    }
    if let Some(file) = PublishedFile::of(path, bytes) {
        if file.is_copy() {
            return Ok(Found::Nothing(SkipReason::Copy));
        }
        return request.several(file.set, || file.read(bytes));
    }
    match ending.as_str() {
        _ if kind == FileKind::Npy => array(path, bytes, request),
        _ if with_small_ending(path).ends_with("userData.mat") => request
            .several(DataSet::named("epn"), || {
                Err(damage(Damage::of_file(OBJECTS)))
            }),
        _ if kind == FileKind::Mat => request.nothing(path, kind),
        "npy" => Err(damage(Damage::of_kind("an npy array", kind))),
        "mat" => request.nothing(path, kind),
        _ => text(path, bytes, request),
    }
}

/// Rows of an array that are looked at.
const FIRST: usize = 100;

/// Fault of the labels of `epn` as published.
const OBJECTS: &str = "the labels of this file are MATLAB objects, which only MATLAB reads: write each recording as \
                       user10/training/001_fist.npy (docs/recordings.md)";

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
            Some(empty) => Err(Damage::of_file(EMPTY).in_file(&empty.path)),
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
    if is_text || has_labels(path) {
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
        wide::in_rows(columns, columns, &rows).map_err(|finding| damage(finding.into()))?;
    }
    match (&array.shape[..], &array.values) {
        ([_, 8], Values::Numbers(_)) => request.unknown(|| own::array(path, &array)),
        (shape, _) if request.alone || matches!(shape, [_, 9] | [8, _]) => {
            let expected = "eight channels of numbers, (n, 8); where a label or times are beside them, a csv with a \
                            header says so, gt,emg_0 to emg_7";
            let fault = error::array(expected, &array.describe());
            Err(damage(Damage::of_file(fault)))
        }
        _ => Ok(Found::Nothing(SkipReason::Layout)),
    }
}

/// Reads text, of any encoding.
fn text(path: &Path, bytes: &[u8], request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) if FileKind::of(bytes) != FileKind::Utf16 => {
            text.strip_prefix('\u{feff}').unwrap_or(text)
        }
        _ => return encoded(path, bytes, request),
    };
    if FileKind::of(bytes) != FileKind::Json {
        return of_text(path, text, request);
    }
    if repetitions::looks_like(text) {
        return Err(repetitions::misplaced().in_file(path));
    }
    if libemg::is_metadata(path, text) {
        return Ok(Found::Part);
    }
    request.nothing(path, FileKind::Json)
}

/// Bytes of a text in another encoding that are decoded, to tell what it would be.
const BEGINNING: usize = 8192;

/// Refuses text in another encoding if it would be a recording in UTF-8.
fn encoded(path: &Path, bytes: &[u8], request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    let kind = FileKind::of(bytes);
    let beginning = &bytes[..bytes.len().min(BEGINNING)];
    let (text, damage) = match std::str::from_utf8(bytes) {
        Err(error) if kind != FileKind::Utf16 => (
            String::from_utf8_lossy(beginning).into_owned(),
            Damage::of_text(error),
        ),
        _ => (utf16(beginning), Damage::of_kind(KINDS, kind)),
    };
    let is_meant = Columns::of(&text).map_or_else(|error| error.is_meant, |_| true);
    // Control characters are in no text of one byte a character.
    let is_text = || kind == FileKind::Utf16 || !bytes.iter().any(|byte| matches!(byte, 0..=8));
    if is_meant || request.alone && is_text() {
        return Err(damage.in_file(path));
    }
    request.nothing(path, kind)
}

/// Text of UTF-16, with or without a byte order mark.
fn utf16(bytes: &[u8]) -> String {
    // Without a mark: the first character of every text format here is ASCII.
    let read = match bytes {
        [0xfe, 0xff, ..] | [0, _, ..] => u16::from_be_bytes,
        _ => u16::from_le_bytes,
    };
    let (units, _) = bytes.as_chunks::<2>();
    let units: Vec<u16> = units.iter().map(|&unit| read(unit)).collect();
    let text = String::from_utf16_lossy(&units);
    text.trim_start_matches('\u{feff}').to_owned()
}

/// Reads rows of numbers.
fn of_text(path: &Path, text: &str, request: &OpenRequest<'_>) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    wide::in_table(text, false).map_err(|finding| damage(finding.into()))?;
    match Columns::of(text) {
        Ok(columns) if columns.names.is_empty() => bare(path, text, &columns, request),
        Ok(columns) => request.several(DataSet::OWN, || own::table(path, text, &columns)),
        Err(_) if !request.wants(DataSet::OWN) => Ok(Found::Nothing(SkipReason::NotWanted)),
        Err(error) if request.alone || error.is_meant => Err(damage(error.damage)),
        Err(_) => Ok(Found::Nothing(SkipReason::Layout)),
    }
}

/// Reads eight channels without a header: LibEMG's, or a user's own.
fn bare(
    path: &Path,
    text: &str,
    columns: &Columns,
    request: &OpenRequest<'_>,
) -> Result<Found, LoadError> {
    let Some(metadata) = libemg::metadata(path) else {
        return request.unknown(|| own::table(path, text, columns));
    };
    request.several(DataSet::OWN, || {
        let pieces = own::table(path, text, columns)?.into_iter();
        Ok(pieces.map(|own| libemg::labelled(own, &metadata)).collect())
    })
}
