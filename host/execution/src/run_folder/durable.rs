//! Writing of files that are complete or absent.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;

use super::RunError;
#[cfg(any(test, feature = "testing"))]
use super::kill;

/// Suffix of a file that is being written.
const PARTIAL: &str = ".partial";

/// Writes a file under a temporary name and renames it when complete.
///
/// The content reaches the disk before the name does, and the name before this returns: after a power failure, too,
/// the file is the old one or the new one. A rename alone promises that for a killed process only, since file systems
/// may write the name first.
///
/// # Errors
/// When the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    write(path, bytes).map_err(|source| RunError::io(path, source))
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(PARTIAL);
    let mut file = File::create(&partial)?;
    #[cfg(any(test, feature = "testing"))]
    {
        use std::io::Seek as _;
        file.write_all(&bytes[..bytes.len() / 2])?;
        kill::point();
        file.rewind()?;
    }
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    #[cfg(any(test, feature = "testing"))]
    kill::point();
    fs::rename(&partial, path)?;
    #[cfg(any(test, feature = "testing"))]
    kill::point();
    sync_folder(path)
}

/// Makes a rename last. Only Unix can open a folder as a file.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    }
    Ok(())
}

/// Removes files that killed processes had not finished writing in a folder.
pub(super) fn remove_partial(folder: &Path) -> io::Result<()> {
    remove_ending(folder, &[PARTIAL])
}

/// Removes the files of a folder whose names have one of these endings.
pub(super) fn remove_ending(folder: &Path, endings: &[&str]) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name: OsString = entry.file_name();
        let name = name.to_string_lossy();
        if endings.iter().any(|ending| name.ends_with(ending)) && entry.file_type()?.is_file() {
            fs::remove_file(entry.path())?;
            #[cfg(any(test, feature = "testing"))]
            kill::point();
        }
    }
    Ok(())
}
