//! Text files: JSON of a published set, or rows of numbers.

use std::path::Path;

use super::{Found, KINDS, OpenRequest};
use crate::catalogue::DataSet;
use crate::description::{own, repetitions};
use crate::examiner::wide;
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::libemg;
use crate::readers::open::SkipReason;
use crate::readers::table::columns::Columns;
use execution::file_kind::FileKind;

/// Reads text, of any encoding.
pub(super) fn open(
    path: &Path,
    bytes: &[u8],
    request: &OpenRequest<'_>,
) -> Result<Found, LoadError> {
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
            Damage::at_byte(error.valid_up_to() as u64, Fault::Text),
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
pub(super) fn of_text(
    path: &Path,
    text: &str,
    request: &OpenRequest<'_>,
) -> Result<Found, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    wide::in_table(text).map_err(|finding| damage(Damage::refused(finding)))?;
    match Columns::of(text) {
        Ok(columns) if columns.names.is_empty() => bare(path, text, &columns, request),
        Ok(columns) => request.several(DataSet::OWN, || own::table(path, text, &columns)),
        Err(_) if !request.wants(DataSet::OWN) => Ok(Found::Nothing(SkipReason::NotWanted)),
        Err(error) if request.alone || error.is_meant => {
            Err(damage(Damage::at_line(error.line, error.fault)))
        }
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
