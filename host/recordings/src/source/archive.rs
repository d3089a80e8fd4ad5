//! Unpacking of untrusted archives: nothing leaves the folder, and nothing grows without bound.
//!
//! Kinds are recognised by content. Links, devices and the like are left out and counted. A name that leads out of the
//! folder refuses the whole archive, which must be hostile.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Component, Path, PathBuf};

use flate2::read::GzDecoder;

use super::error::FetchError;
use execution::file_kind::FileKind;

/// Bounds of an archive's content.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Maximum number of files and folders.
    pub entries: u64,
    /// Maximum size of all files together, in bytes.
    pub bytes: u64,
}

impl Bounds {
    /// Bounds for an archive of this many bytes: text is never compressed to less than a hundredth, a bomb is to much
    /// less.
    pub(super) fn of(archive: u64) -> Self {
        const RATIO: u64 = 100;
        const SMALL: u64 = 64 << 20;
        const MOST: u64 = 64 << 30;
        Self {
            entries: 500_000,
            bytes: (archive.saturating_mul(RATIO) + SMALL).min(MOST),
        }
    }
}

/// Result of unpacking an archive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unpacked {
    /// Files written.
    pub files: u64,
    /// Bytes of these files.
    pub bytes: u64,
    /// Links and other entries that are no files, left out.
    pub left_out: u64,
}

/// Whether a file is an archive that [`unpack`] knows.
pub(super) fn is_archive(path: &Path) -> io::Result<bool> {
    let archives = [FileKind::Zip, FileKind::Tar, FileKind::Gzip];
    Ok(archives.contains(&kind(path)?))
}

fn kind(path: &Path) -> io::Result<FileKind> {
    let mut start = Vec::new();
    File::open(path)?.take(512).read_to_end(&mut start)?;
    Ok(FileKind::of(&start))
}

/// Unpacks an archive into an existing folder.
pub(super) fn unpack(
    archive: &Path,
    folder: &Path,
    bounds: Bounds,
) -> Result<Unpacked, FetchError> {
    let damaged = |error| FetchError::io(archive, error);
    let kind = kind(archive).map_err(damaged)?;
    let file = File::open(archive).map_err(damaged)?;
    let mut target = Target {
        archive,
        folder,
        bounds,
        entries: 0,
        done: Unpacked::default(),
    };
    match kind {
        FileKind::Zip => target.zip(BufReader::new(file))?,
        FileKind::Tar => target.tar(BufReader::new(file))?,
        FileKind::Gzip => target.tar(GzDecoder::new(BufReader::new(file)))?,
        found => {
            let fault = format!("expected a zip, tar or tar.gz archive, found {found}");
            return Err(FetchError::io(archive, fault));
        }
    }
    Ok(target.done)
}

/// A folder that is being filled.
struct Target<'a> {
    archive: &'a Path,
    folder: &'a Path,
    bounds: Bounds,
    entries: u64,
    done: Unpacked,
}

impl Target<'_> {
    fn zip(&mut self, file: BufReader<File>) -> Result<(), FetchError> {
        let path = self.archive;
        let damaged = |error| FetchError::io(path, error);
        let mut archive = zip::ZipArchive::new(file).map_err(damaged)?;
        for at in 0..archive.len() {
            self.count()?;
            let mut entry = archive.by_index(at).map_err(damaged)?;
            let name = entry.name().map_err(damaged)?.into_owned();
            if entry.is_dir() {
                self.make_folder(&name)?;
            } else if entry.is_symlink() || !entry.is_file() {
                self.done.left_out += 1;
            } else {
                self.write(&name, &mut entry)?;
            }
        }
        Ok(())
    }

    fn tar(&mut self, file: impl Read) -> Result<(), FetchError> {
        let path = self.archive;
        let damaged = |error: io::Error| FetchError::io(path, error);
        let mut archive = tar::Archive::new(file);
        for entry in archive.entries().map_err(damaged)? {
            self.count()?;
            let mut entry = entry.map_err(damaged)?;
            let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
            match entry.header().entry_type() {
                tar::EntryType::Directory => self.make_folder(&name)?,
                tar::EntryType::Regular | tar::EntryType::Continuous => {
                    self.write(&name, &mut entry)?;
                }
                // Git writes the revision before the files.
                tar::EntryType::XGlobalHeader => {}
                _ => self.done.left_out += 1,
            }
        }
        Ok(())
    }

    fn count(&mut self) -> Result<(), FetchError> {
        self.entries += 1;
        within(self.entries, self.bounds.entries, "files")
    }

    fn make_folder(&self, name: &str) -> Result<(), FetchError> {
        let path = self.folder.join(inside(name)?);
        fs::create_dir_all(&path).map_err(|source| FetchError::io(&path, source))
    }

    fn write(&mut self, name: &str, content: &mut impl Read) -> Result<(), FetchError> {
        let path = self.folder.join(inside(name)?);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|source| FetchError::io(parent, source))?;
        }
        // A second file of the name, even if only its case differs, writes over nothing.
        let mut file = File::create_new(&path).map_err(|source| {
            if source.kind() == io::ErrorKind::AlreadyExists {
                let fault = format!("the archive has {name:?} twice: nothing of it is unpacked");
                FetchError::new(fault)
            } else {
                FetchError::io(&path, source)
            }
        })?;
        // Bytes are counted as they come, whatever number the archive states.
        let left = self.bounds.bytes - self.done.bytes;
        let copied = io::copy(&mut content.take(left + 1), &mut file);
        self.done.bytes += copied.map_err(|error| FetchError::io(self.archive, error))?;
        within(self.done.bytes, self.bounds.bytes, "bytes")?;
        self.done.files += 1;
        Ok(())
    }
}

/// Refuses an archive with more than its bounds allow.
fn within(count: u64, most: u64, what: &str) -> Result<(), FetchError> {
    if count > most {
        let fault = format!("the archive holds more than {most} {what}: nothing of it is unpacked");
        return Err(FetchError::new(fault));
    }
    Ok(())
}

/// The path of an entry below the folder.
fn inside(name: &str) -> Result<PathBuf, FetchError> {
    /// Maximum depth of folders.
    const DEPTH: usize = 32;
    let escapes = || {
        FetchError::new(format!(
            "the archive has a file named {name:?}, which leads out of its folder: nothing of it is unpacked"
        ))
    };
    // Some programs on Windows write their own separator.
    let path = name.replace('\\', "/");
    if path.contains(['\0', ':']) {
        return Err(escapes());
    }
    let mut inside = PathBuf::new();
    for component in Path::new(&path).components() {
        match component {
            Component::Normal(part) => inside.push(part),
            Component::CurDir => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                return Err(escapes());
            }
        }
    }
    if inside.as_os_str().is_empty() || inside.components().count() > DEPTH {
        return Err(escapes());
    }
    Ok(inside)
}

#[cfg(test)]
mod tests;
