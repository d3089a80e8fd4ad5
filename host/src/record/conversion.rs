//! Conversion of a journal to recordings, at the end of a session or at the next start.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use shared::units::Sample;
use web::record::assembly::assemble;
use web::record::csv::{csv, movement, pieces};
use web::record::quality::{Finding, Quality, judge};

use super::RecordError;
use super::journal::{ENDING, SECOND, open};
use execution::run_folder::write_whole;
use recordings::labels::motion::GroundTruth;
use recordings::{LoadOptions, imu, load};

/// File extension of a journal that the disk has damaged.
const DAMAGED: &str = "journal.damaged";

/// Recordings made of a session.
#[derive(Clone, PartialEq, Debug)]
pub struct Conversion {
    /// Paths of the recordings, in order.
    pub(crate) files: Vec<PathBuf>,
    /// Quality of the recordings.
    pub(crate) quality: Quality,
    /// Number of trials that are not used.
    pub(crate) rejected: usize,
    /// Number of bytes of an unfinished line at the journal's end.
    pub(crate) left_off: usize,
}

impl Conversion {
    /// Sentence on what is lost of a damaged journal; none if it was whole.
    pub(crate) fn damage(&self) -> Option<String> {
        let mut findings = self.quality.findings.iter();
        let damaged = findings.find(|finding| matches!(finding, Finding::Damaged { .. }));
        damaged.map(ToString::to_string)
    }

    /// Upper bound of the seconds in the unfinished line.
    pub(crate) fn seconds_left_off(&self) -> f64 {
        self.left_off as f64 / SECOND as f64
    }
}

/// Makes recordings beside a journal, reads them back, and removes the journal.
///
/// # Errors
/// See [`RecordError`]. The journal stays where it is, and the next start tries again.
pub(crate) fn convert(journal: &Path) -> Result<Conversion, RecordError> {
    let (lock, header, contents) = open(journal)?;
    let assembly = assemble(&contents.entries);
    let mut files = Vec::new();
    for (number, (part, piece)) in (1..).zip(pieces(&assembly)) {
        let path = file(journal, number);
        let text = csv(&assembly, part, piece.clone(), header.synthetic);
        write(journal, &path, &text)?;
        if let Some(text) = movement(part, &piece) {
            write(journal, &imu::beside(&path), &text)?;
        }
        let read = load(&path, &LoadOptions::default())?;
        if let (true, Some(refused)) = (read.recordings.is_empty(), read.skipped.first()) {
            let reason = refused.line();
            return Err(RecordError::Refused { reason });
        }
        let aligned = |at: usize| part.placements[at].apply(part.samples[at]);
        let samples: Vec<Sample> = piece.clone().map(aligned).collect();
        let truth: GroundTruth = part.motions[piece].iter().copied().collect();
        let same = read.recordings.first().is_some_and(|recording| {
            recording.samples == samples
                && recording.labels == truth.labels
                && recording.other_movement == truth.other_movement
        });
        if !same {
            return Err(RecordError::Unlike { path });
        }
        files.push(path);
    }
    let conversion = Conversion {
        quality: judge(&assembly),
        files,
        rejected: assembly.rejected.len(),
        left_off: contents.left_off,
    };
    let put_away = if contents.is_damaged() {
        fs::rename(journal, journal.with_extension(DAMAGED))
    } else {
        fs::remove_file(journal)
    };
    drop(lock);
    put_away.map_err(RecordError::io(journal))?;
    Ok(conversion)
}

/// Writes a file of a journal, unless another one is there.
fn write(journal: &Path, path: &Path, text: &str) -> Result<(), RecordError> {
    // A program that was killed half-way may have written the file before.
    let is_own = fs::read(path).is_ok_and(|found| found == text.as_bytes());
    if path.exists() && !is_own {
        let path = path.to_owned();
        return Err(RecordError::Exists { path });
    }
    write_whole(path, text.as_bytes()).map_err(|error| RecordError::Write {
        journal: journal.to_owned(),
        error,
    })
}

/// Path of a recording: `anna_20261122T110323Z_quick_1.csv`.
fn file(journal: &Path, number: usize) -> PathBuf {
    let stem = journal.file_stem().unwrap_or_default().to_string_lossy();
    journal.with_file_name(format!("{stem}_{number}.csv"))
}

/// Makes recordings of all journals in a person's folder that no session writes: their sessions were killed, or the disk was
/// full. Returns the result for each.
///
/// # Errors
/// When the folder cannot be read. A missing folder has no journals.
pub fn recover(folder: &Path) -> io::Result<Vec<(PathBuf, Result<Conversion, RecordError>)>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let mut journals = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == ENDING) {
            journals.push(path);
        }
    }
    journals.sort();
    let conversions = journals
        .into_iter()
        .filter_map(|path| match convert(&path) {
            // Another session writes it, or was killed before its first line was complete.
            Err(RecordError::Busy { .. }) => None,
            Err(RecordError::Empty { .. }) => {
                let removed = fs::remove_file(&path).map_err(RecordError::io(&path));
                removed.err().map(|error| (path, Err(error)))
            }
            result => Some((path, result)),
        });
    Ok(conversions.collect())
}

#[cfg(test)]
mod tests;
