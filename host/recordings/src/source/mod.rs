//! Published data sets: download and unpacking.

mod archive;
mod checksum;
mod client;
mod error;
mod plan;
mod transfer;

use std::fs;
use std::path::{Path, PathBuf};

pub use archive::Unpacked;
use error::FetchError;
pub use plan::{Download, Plan, ZENODO, plan};

use super::catalogue::{DataSet, Source};
use super::library::{LoadOptions, load};
use super::readers::error::LoadError;
use execution::bounded_read::regular;
use execution::progress;

/// A file that was received completely.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// The file.
    pub path: PathBuf,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// Downloads the files of a plan into a folder; files that are there in part are continued.
///
/// # Errors
/// When a file cannot be had whole, or is not the published one.
pub fn download(plan: &Plan, source: &Source, folder: &Path) -> Result<Vec<Received>, FetchError> {
    fs::create_dir_all(folder).map_err(|error| FetchError::io(folder, error))?;
    let files = plan.downloads.iter();
    files.map(|of| one(of, source, folder)).collect()
}

fn one(of: &Download, source: &Source, folder: &Path) -> Result<Received, FetchError> {
    let bar = progress::bytes(of.size, &of.file);
    let path = transfer::Transfer::new(of, &source.page, folder, &bar).run()?;
    bar.finish_and_clear();
    let io = |error| FetchError::io(&path, error);
    if let Some(expected) = &of.checksum {
        let found = checksum::md5(&path).map_err(io)?;
        if found != *expected {
            fs::remove_file(&path).map_err(io)?;
            return Err(FetchError::new(format!(
                "{}: expected {expected}, found {found}: the download is damaged, or was changed after its checksum was \
                 published; it is removed",
                of.file
            )));
        }
    }
    Ok(Received {
        sha256: checksum::sha256(&path).map_err(io)?,
        path,
    })
}

/// Unpacks archives, and copies other files, into a new folder. They are put beside it first, and renamed when complete
/// and with a recording of the data set.
///
/// # Errors
/// When the folder is there already, a file cannot be unpacked, or none is a recording of the set; nothing is left
/// then.
pub fn put_in_place(
    files: &[PathBuf],
    folder: &Path,
    data_set: DataSet,
) -> Result<Unpacked, FetchError> {
    free(folder)?;
    for path in files {
        let kind = fs::metadata(path).and_then(|metadata| regular(metadata.file_type()));
        kind.map_err(|error| FetchError::io(path, error))?;
    }
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let beside = folder.with_file_name(format!(".{name}.unpacking"));
    let above = folder.parent().filter(|above| !above.exists());
    let result = unpack_all(files, &beside);
    let renamed = result.and_then(|unpacked| {
        must_hold(&beside, data_set)?;
        fs::rename(&beside, folder).map_err(|error| FetchError::io(folder, error))?;
        Ok(unpacked)
    });
    if renamed.is_err() {
        let _ = fs::remove_dir_all(&beside);
        // Restores the state before; a folder with other content by now stays.
        let _ = above.map(fs::remove_dir);
    }
    renamed
}

/// Refuses a folder without a recording of the data set.
fn must_hold(folder: &Path, data_set: DataSet) -> Result<(), FetchError> {
    let options = LoadOptions {
        data_sets: vec![data_set],
        ..LoadOptions::default()
    };
    let other = |found: String| {
        FetchError::new(format!(
            "expected recordings of {} ({}), found {found}: is it the right archive? Nothing of it is kept",
            data_set.name(),
            data_set.recognised_by()
        ))
    };
    match load(folder, &options) {
        Ok(library) if !library.recordings.is_empty() => Ok(()),
        Ok(library) => Err(other(format!(
            "{} damaged or unreadable files",
            library.skipped.len()
        ))),
        Err(LoadError::NoRecordings { found, .. }) => Err(other(found)),
        Err(error) => Err(other(error.line())),
    }
}

/// Refuses a folder that is there already.
pub fn free(folder: &Path) -> Result<(), FetchError> {
    if folder.exists() {
        let folder = folder.display();
        let words = format!("{folder} exists: remove it, or choose another folder with --to");
        return Err(FetchError::new(words));
    }
    Ok(())
}

fn unpack_all(files: &[PathBuf], beside: &Path) -> Result<Unpacked, FetchError> {
    // Left by a command that was killed.
    if beside.exists() {
        fs::remove_dir_all(beside).map_err(|error| FetchError::io(beside, error))?;
    }
    fs::create_dir_all(beside).map_err(|error| FetchError::io(beside, error))?;
    let mut all = Unpacked::default();
    for path in files {
        let io = |error| FetchError::io(path, error);
        let length = fs::metadata(path).map_err(io)?.len();
        let own = if archive::is_archive(path).map_err(io)? || files.len() == 1 {
            archive::unpack(path, beside, archive::Bounds::of(length))?
        } else {
            let to = beside.join(path.file_name().unwrap_or_default());
            fs::copy(path, to).map_err(io)?;
            Unpacked {
                files: 1,
                bytes: length,
                left_out: 0,
            }
        };
        all.files += own.files;
        all.bytes += own.bytes;
        all.left_out += own.left_out;
    }
    Ok(all)
}

#[cfg(test)]
mod tests;
