//! One file: which format it has, and the recordings in it.

use std::path::Path;

use super::error::{Damage, Fault, LoadError};
use super::formats::{
    cote_allard, emg_epn, myo_readings, one_subject_myo, react_emg, roshambo, ss_stm,
};
use super::layout::Layout;
use super::npy::{self, Values};
use crate::dataset::recording::{DataSet, Recording};

/// What one file turned out to be.
pub(crate) enum Found {
    Recordings(Vec<Recording>),
    /// Belongs to a recording whose samples are in another file.
    Part,
    /// No recording, none of a data set that is wanted, or none of the six classes.
    Nothing,
}

/// Reads one file if it is a recording of a data set that is wanted.
pub(crate) fn open(path: &Path, wants: impl Fn(DataSet) -> bool) -> Result<Found, LoadError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    // What only the name decides: headerless binary could be anything.
    if !matches!(extension, "npy" | "csv" | "txt" | "dat" | "json") {
        return Ok(Found::Nothing);
    }
    let bytes = std::fs::read(path).map_err(|source| LoadError::Io {
        path: path.to_owned(),
        source,
    })?;
    if bytes.is_empty() {
        return Err(Damage::of_file(Fault::Empty).in_file(path));
    }
    if extension == "dat" {
        if !wants(DataSet::CoteAllard) {
            return Ok(Found::Nothing);
        }
        return one(path, cote_allard::read(path, &bytes));
    }
    if extension == "npy" || npy::looks_like(&bytes) {
        return array(path, &bytes, wants);
    }
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Ok(Found::Nothing);
    };
    if extension == "json" {
        if !wants(DataSet::EmgEpn612) || !emg_epn::looks_like(text) {
            return Ok(Found::Nothing);
        }
        let user = emg_epn::read(path, text).map_err(|damage| damage.in_file(path))?;
        return Ok(Found::Recordings(user));
    }
    let layout = Layout::of(text).filter(|layout| wants(layout.data_set()));
    match layout {
        Some(Layout::ReactEmg) => one(path, react_emg::read_csv(path, text)),
        Some(Layout::MyoReadings) => {
            let recording = myo_readings::read(path, text);
            let recording = recording.map_err(|damage| damage.in_file(path))?;
            Ok(recording.map_or(Found::Nothing, |recording| {
                Found::Recordings(vec![recording])
            }))
        }
        Some(Layout::SsStm) => one(path, ss_stm::read(path, text)),
        Some(Layout::OneSubjectMyo) => {
            let metadata = std::fs::read_to_string(path.with_file_name("metadata.json")).ok();
            one(path, one_subject_myo::read(path, text, metadata.as_deref()))
        }
        None => Ok(Found::Nothing),
    }
}

fn one(path: &Path, recording: Result<Recording, Damage>) -> Result<Found, LoadError> {
    let recording = recording.map_err(|damage| damage.in_file(path))?;
    Ok(Found::Recordings(vec![recording]))
}

fn array(path: &Path, bytes: &[u8], wants: impl Fn(DataSet) -> bool) -> Result<Found, LoadError> {
    let array = npy::parse(bytes).map_err(|damage| damage.in_file(path))?;
    match (&array.shape[..], &array.values) {
        // Annotations of `roshambo`, read with their samples.
        ([_], Values::Text(_)) => Ok(Found::Part),
        _ if roshambo::is_samples(path, &array) => {
            if !wants(DataSet::Roshambo) {
                return Ok(Found::Nothing);
            }
            Ok(Found::Recordings(vec![roshambo::read(path, &array)?]))
        }
        _ if wants(DataSet::ReactEmg) && react_emg::is_recording(&array) => {
            one(path, react_emg::read_npy(path, &array))
        }
        _ => Ok(Found::Nothing),
    }
}
