//! Reading whole files, with a bound on what is read.
//!
//! A named pipe waits for a writer and `/dev/zero` never ends: only regular files are opened, and a file that is
//! larger than anything sensible is refused before memory is filled with it.

use std::fs::{self, File, FileType};
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

use super::file_kind::FileKind;

const MIB: u64 = 1 << 20;

/// Maximum size of a file of recordings, in bytes: 23 hours of the armband at one byte per value.
pub const RECORDING: u64 = 128 * MIB;
/// Maximum size of a model file, in bytes: many times what a board's flash holds.
const MODEL: u64 = 16 * MIB;
/// Maximum size of a checkpoint to start from, in bytes: two thousand times the paper's teacher.
pub const CHECKPOINT: u64 = 1024 * MIB;
/// Maximum size of a preset, in bytes.
pub const PRESET: u64 = MIB;

/// Reason why a file is not read.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub(crate) enum Refusal {
    #[error("expected a regular file, found {0}")]
    Kind(&'static str),
    #[error("expected a model file (.intent), found {0}")]
    NoModel(FileKind),
    #[error("expected at most {} MiB, found more: give a smaller file", most / MIB)]
    Large { most: u64 },
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// As [`fs::read`]; with a `Refusal` inside for a file that is not regular, or too large.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // The kind is checked before the file is opened, because opening a pipe waits.
    regular(fs::metadata(path)?.file_type())?;
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    regular(metadata.file_type())?;
    let large = || io::Error::new(ErrorKind::FileTooLarge, Refusal::Large { most });
    if metadata.len() > most {
        return Err(large());
    }
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
    // Reading is bounded again, because a file may grow, and files of /proc have no length.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(large());
    }
    Ok(bytes)
}

/// Reads a regular file of at most `most` bytes of UTF-8.
///
/// # Errors
/// As [`fs::read_to_string`]; with the reason inside for a file that is not regular, or too large.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let invalid = |error| io::Error::new(ErrorKind::InvalidData, error);
    String::from_utf8(read(path, most)?).map_err(invalid)
}

/// Reads a model file, which is refused by its kind if its first bytes mark another kind.
///
/// Without such a file, a shipped model has the path `three-class.intent` or `models/three-class.intent`.
///
/// # Errors
/// As [`read`]; with `Refusal::NoModel` inside for a file of another kind.
pub fn read_model(path: &Path) -> io::Result<Vec<u8>> {
    let bytes = match (read(path, MODEL), shipped_model(path)) {
        (Err(error), Some(model)) if error.kind() == ErrorKind::NotFound => model.to_vec(),
        (read, _) => read?,
    };
    match FileKind::of(&bytes) {
        FileKind::Model => Ok(bytes),
        other => Err(io::Error::new(
            ErrorKind::InvalidData,
            Refusal::NoModel(other),
        )),
    }
}

fn shipped_model(path: &Path) -> Option<&'static [u8]> {
    let name = path.strip_prefix("models").unwrap_or(path);
    let model = models::SHIPPED
        .iter()
        .find(|(own, _)| name == Path::new(own))?;
    Some(model.1)
}

/// Refuses folders, devices, pipes, sockets and, where it was not followed, a link.
///
/// # Errors
/// An error with `Refusal::Kind` inside.
pub fn regular(kind: FileType) -> io::Result<()> {
    if kind.is_file() {
        return Ok(());
    }
    let what = if kind.is_dir() {
        "a folder"
    } else if kind.is_symlink() {
        "a link"
    } else {
        "a device, pipe or socket"
    };
    Err(io::Error::new(ErrorKind::InvalidInput, Refusal::Kind(what)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(error: &io::Error) -> Option<&Refusal> {
        error.get_ref()?.downcast_ref()
    }

    #[test]
    fn a_file_is_read_up_to_the_bound_and_refused_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read(&path, 100).unwrap(), [7; 100]);
        let error = read(&path, 99).unwrap_err();
        assert_eq!(refusal(&error), Some(&Refusal::Large { most: 99 }));
    }

    #[test]
    fn shipped_models_need_no_file_and_a_file_comes_first() {
        for (name, model) in models::SHIPPED {
            for path in [Path::new(name), &Path::new("models").join(name)] {
                assert!(read_model(path).unwrap() == model, "{}", path.display());
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("three-class.intent");
        assert_eq!(read_model(&path).unwrap_err().kind(), ErrorKind::NotFound);
        fs::write(&path, &models::THREE_CLASS[..100]).unwrap();
        assert_eq!(read_model(&path).unwrap(), models::THREE_CLASS[..100]);
    }

    #[cfg(unix)]
    #[test]
    fn folders_and_devices_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path(), Path::new("/dev/zero")] {
            let error = read(path, 100).unwrap_err();
            assert!(matches!(refusal(&error), Some(Refusal::Kind(_))), "{error}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_without_a_length_is_bounded_too() {
        let path = Path::new("/proc/self/maps");
        assert!(read(path, RECORDING).unwrap().len() > 10);
        assert!(refusal(&read(path, 10).unwrap_err()).is_some());
    }
}
