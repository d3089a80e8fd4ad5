//! Names of recordings. Labels, pages and other programs keep a file for each recording under its name, so no two names
//! may be one file's: not in another case, and not with `.` or spaces that a file system leaves out.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;

use super::Library;
use crate::recording::Recording;

impl Library {
    /// The first two recordings whose names would be one file. Only recordings of several paths can have them.
    pub fn named_alike(&self) -> Option<[&Recording; 2]> {
        let mut named = HashMap::new();
        let mut recordings = self.recordings.iter();
        recordings.find_map(|own| Some([named.insert(as_file(own), own)?, own]))
    }
}

/// Names recordings whose names are one file's after their whole file, with its ending; and numbers those that it does not
/// tell apart.
pub(super) fn make_unique(recordings: &mut [Recording]) {
    let mut counts: HashMap<String, usize> = HashMap::new();
    for own in &*recordings {
        *counts.entry(as_file(own)).or_default() += 1;
    }
    for own in &mut *recordings {
        if counts[&as_file(own)] > 1 {
            own.name = with_ending(own);
        }
    }
    let mut taken = HashSet::new();
    for own in recordings {
        let name = own.name.clone();
        let mut number = 1;
        while !taken.insert(as_file(own)) {
            number += 1;
            own.name = format!("{name}-{number}");
        }
    }
}

/// A recording's full name as the least exact file system sees it.
fn as_file(recording: &Recording) -> String {
    let name = recording.full_name().to_lowercase();
    let parts = name
        .split('/')
        .map(|part| part.trim_end_matches(['.', ' ']));
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    parts.join("/")
}

/// A recording's name with the ending of its file: `day1/x.csv.2` for the second piece of `x.csv`.
fn with_ending(recording: &Recording) -> String {
    let text = |name: Option<&OsStr>| name.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, file) = (
        text(recording.path.file_stem()),
        text(recording.path.file_name()),
    );
    let name = &recording.name;
    let at = name.rfind('/').map_or(0, |slash| slash + 1);
    let piece = name[at..].strip_prefix(&stem);
    piece.map_or_else(
        || name.clone(),
        |piece| format!("{}{file}{piece}", &name[..at]),
    )
}
