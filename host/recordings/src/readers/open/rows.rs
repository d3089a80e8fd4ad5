//! Text files: JSON of a published set, or rows of numbers.

use std::path::Path;

use super::{Found, KINDS, Request};
use crate::examiner::bands;
use crate::finding::Finding;
use crate::readers::columns::Columns;
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::formats::{
    emg_epn, libemg, myo_readings, myo_rps, one_subject_myo, react_emg, ss_stm, uci_gestures,
};
use crate::readers::separator::Separator;
use crate::readers::shape::Shape;
use crate::readers::table;
use crate::readers::text;
use crate::readers::why::Why;
use crate::recording::{DataSet, Recording};
use execution::file_kind::FileKind;

/// Reads text, of any encoding.
pub(super) fn open(
    path: &Path,
    bytes: &[u8],
    request: &Request<impl Fn(DataSet) -> bool>,
) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    let text = match std::str::from_utf8(bytes) {
        Ok(text) if FileKind::of(bytes) != FileKind::Utf16 => {
            text.strip_prefix('\u{feff}').unwrap_or(text)
        }
        _ => return encoded(path, bytes, request),
    };
    if FileKind::of(bytes) != FileKind::Json {
        return of_text(path, text, request);
    }
    if emg_epn::looks_like(text) {
        return request.several(DataSet::EmgEpn612, || {
            emg_epn::read(path, text).map_err(damage)
        });
    }
    if path.ends_with("metadata.json") && text.contains(libemg::CLASS) {
        return Ok(Found::Part);
    }
    request.nothing(path, FileKind::Json)
}

/// Refuses text in another encoding if it would be a recording in UTF-8.
fn encoded(
    path: &Path,
    bytes: &[u8],
    request: &Request<impl Fn(DataSet) -> bool>,
) -> Result<Found, LoadError> {
    let kind = FileKind::of(bytes);
    let (text, fault) = match (kind, std::str::from_utf8(bytes)) {
        (FileKind::Utf16, _) | (_, Ok(_)) => {
            let expected = KINDS;
            let fault = Fault::Kind {
                expected,
                found: kind,
            };
            (text::of_utf16(bytes), Damage::of_file(fault))
        }
        (_, Err(error)) => {
            let at = error.valid_up_to() as u64;
            (text::of_utf8(bytes), Damage::at_byte(at, Fault::Text))
        }
    };
    let is_meant = Columns::of(&text).map_or_else(|unlike| unlike.is_meant, |_| true);
    // Control characters are in no text of one byte a character.
    let is_text = || kind == FileKind::Utf16 || !bytes.iter().any(|byte| matches!(byte, 0..=8));
    if is_meant || request.alone && is_text() {
        return Err(fault.in_file(path));
    }
    request.nothing(path, kind)
}

/// Reads rows of numbers.
pub(super) fn of_text(
    path: &Path,
    text: &str,
    request: &Request<impl Fn(DataSet) -> bool>,
) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    if myo_rps::is_recording(path, text) {
        return request.one(DataSet::MyoRps, || {
            myo_rps::read(path, text).map_err(damage)
        });
    }
    if uci_gestures::is_recording(path, text) {
        return request.one(DataSet::UciGestures, || {
            uci_gestures::read(path, text).map_err(damage)
        });
    }
    let shape = Shape::of(text);
    let commas = shape.filter(|shape| shape.separator == Separator::Comma);
    match commas.map(|shape| (shape.columns, shape.is_decimal)) {
        Some((9, _)) if myo_readings::is_named(path) => {
            return request.one(DataSet::MyoReadings, || {
                myo_readings::read(path, text).map_err(damage)
            });
        }
        Some((8, true)) if ss_stm::is_named(path) => {
            return request.one(DataSet::SsStm, || ss_stm::read(path, text).map_err(damage));
        }
        _ => {}
    }
    two_armbands(text, shape).map_err(|finding| damage(Damage::refused(finding)))?;
    match Columns::of(text) {
        Ok(columns) if columns.names.is_empty() => bare(path, text, &columns, request),
        Ok(columns) => request.several(DataSet::ReactEmg, || {
            react_emg::read_csv(path, text, &columns).map_err(damage)
        }),
        Err(_) if !(request.wants)(DataSet::ReactEmg) => Ok(Found::Nothing(Why::NotWanted)),
        Err(unlike) if request.alone || unlike.is_meant => {
            Err(damage(Damage::at_line(unlike.line, unlike.fault)))
        }
        Err(_) => Ok(Found::Nothing(Why::Layout)),
    }
}

/// Refuses a table with the channels of two armbands, by its header or by numbers alone.
fn two_armbands(text: &str, shape: Option<Shape>) -> Result<(), Finding> {
    let mut rows = table::rows(text).map(|(_, row)| row);
    let first = rows.find(|row| !table::is_note(row)).unwrap_or_default();
    match (Shape::of(first), shape) {
        (Some(_), Some(shape)) => bands::in_row(shape.columns),
        _ => bands::in_header(&Separator::of(first).fields(first)),
    }
}

/// Reads eight channels without a header: published, LibEMG's, or a user's own.
fn bare(
    path: &Path,
    text: &str,
    columns: &Columns,
    request: &Request<impl Fn(DataSet) -> bool>,
) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    let recording = react_emg::read_csv(path, text, columns);
    let samples = match recording.as_deref() {
        Ok([recording]) => Some(&recording.samples[..]),
        _ => None,
    };
    let metadata = libemg::metadata(path);
    if samples.is_some_and(one_subject_myo::is_published) {
        return request.one(DataSet::OneSubjectMyo, || {
            let samples = recording.map_err(damage)?.remove(0).samples;
            one_subject_myo::read(path, samples, metadata.as_deref()).map_err(damage)
        });
    }
    if let Some(metadata) = metadata {
        return request.one(DataSet::ReactEmg, || {
            let recording = recording.map_err(damage)?.remove(0);
            let found = libemg::read(path, recording.samples, &metadata).map_err(damage)?;
            Ok(Recording {
                findings: recording.findings,
                ..found
            })
        });
    }
    request.unknown(|| recording.map_err(damage))
}
