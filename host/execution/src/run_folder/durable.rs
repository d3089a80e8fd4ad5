//! Writing of files that are complete or absent.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;

use super::RunError;

/// Suffix of a file that is being written; a killed process leaves it.
pub(super) const PARTIAL: &str = ".partial";

/// Writes a file under a temporary name and renames it when complete.
///
/// The content reaches the disk before the name does, and the name before this returns: after a power failure, too,
/// the file is the old one or the new one. A rename alone promises that for a killed process only, since file systems
/// may write the name first.
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

/// A kill at a chosen point between two changes of the disk, for tests.
///
/// A killed process leaves its files and nothing else; so does one whose stack is unwound without any cleaning up of files.
#[cfg(any(test, feature = "testing"))]
pub mod kill {
    use std::cell::Cell;
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

    thread_local! {
        /// Points to pass before the kill; none without one.
        static LEFT: Cell<Option<usize>> = const { Cell::new(None) };
    }

    struct Killed;

    /// Runs `work` up to its point number `points`, from 0 on; none if it was killed there, its result if it has
    /// fewer points. Only points in the calling thread count.
    pub fn after<T>(points: usize, work: impl FnOnce() -> T) -> Option<T> {
        LEFT.set(Some(points));
        let result = catch_unwind(AssertUnwindSafe(work));
        LEFT.set(None);
        match result {
            Ok(result) => Some(result),
            Err(cause) if cause.is::<Killed>() => None,
            Err(cause) => resume_unwind(cause),
        }
    }

    /// A point at which the process may be killed.
    pub(crate) fn point() {
        match LEFT.get() {
            // Without the panic hook, which would print it.
            Some(0) => resume_unwind(Box::new(Killed)),
            Some(left) => LEFT.set(Some(left - 1)),
            None => {}
        }
    }
}
