//! Drive of a boot loader for UF2 files: found, told by its board, written.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use super::flash::{FlashError, UsbBoard};

/// File in which a boot loader says what board it is on. Source: github.com/microsoft/uf2, README.
const INFO: &str = "INFO_UF2.TXT";
/// Name of the file that is written; the boot loader takes any.
const WRITTEN: &str = "FIRMWARE.UF2";
/// Bytes of the information that are read: a boot loader's file is one sector.
const INFO_BYTES: u64 = 4096;

/// Drive of a board that waits for a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Drive {
    /// Folder at which it is mounted.
    pub path: PathBuf,
    /// Board; none of those that there is firmware for if absent.
    pub board: Option<UsbBoard>,
    /// `Board-ID` of the boot loader.
    pub id: String,
}

impl Drive {
    /// The drive at a folder; none if the folder is none.
    #[must_use]
    pub fn at(path: &Path) -> Option<Self> {
        let info = execution::bounded_read::read(&path.join(INFO), INFO_BYTES).ok()?;
        let info = String::from_utf8_lossy(&info);
        let id = info
            .lines()
            .find_map(|line| line.strip_prefix("Board-ID:"))?
            .trim();
        Some(Self {
            path: path.to_owned(),
            board: UsbBoard::with_id(id),
            id: id.to_owned(),
        })
    }

    /// The only drive among folders, or the only one of a board that is asked for; none if there is none.
    ///
    /// # Errors
    /// [`FlashError::Drives`].
    pub fn among(
        folders: impl IntoIterator<Item = PathBuf>,
        board: Option<UsbBoard>,
    ) -> Result<Option<Self>, FlashError> {
        let mut found: Vec<_> = folders
            .into_iter()
            .filter_map(|path| Self::at(&path))
            .collect();
        if found.len() > 1 && board.is_some() {
            found.retain(|drive| drive.board == board);
        }
        match found.len() {
            0 | 1 => Ok(found.pop()),
            _ => Err(FlashError::Drives {
                paths: found.into_iter().map(|drive| drive.path).collect(),
            }),
        }
    }

    /// Copies a file onto the drive. The board takes it block by block and starts after the last one.
    ///
    /// # Errors
    /// [`FlashError::Full`], [`FlashError::Unwritable`].
    pub fn write(&self, file: &[u8]) -> Result<(), FlashError> {
        let path = self.path.join(WRITTEN);
        let written = File::create(&path).and_then(|mut out| {
            out.write_all(file)?;
            // The board starts with the last block, and its drive may go before the system is done: what it runs says whether
            // it has all.
            let _ = out.sync_all();
            Ok(())
        });
        written.map_err(|source| match source.kind() {
            ErrorKind::StorageFull => FlashError::Full { path },
            _ => FlashError::Unwritable { path, source },
        })
    }
}

/// Folders at which drives may be mounted.
#[must_use]
pub fn mounted() -> Vec<PathBuf> {
    if cfg!(windows) {
        return ('D'..='Z')
            .map(|letter| format!("{letter}:\\").into())
            .collect();
    }
    if cfg!(target_os = "macos") {
        return folders(Path::new("/Volumes")).unwrap_or_default();
    }
    fat(&fs::read_to_string("/proc/mounts").unwrap_or_default())
}

fn folders(path: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect()
}

/// Folders of FAT file systems in Linux's table of mounts. Others are not looked at: those of a network may not answer.
fn fat(mounts: &str) -> Vec<PathBuf> {
    let lines = mounts.lines().filter_map(|line| {
        let mut fields = line.split(' ').skip(1);
        let (folder, kind) = (fields.next()?, fields.next()?);
        // Spaces of a name are written as their octal code.
        matches!(kind, "vfat" | "msdos").then(|| folder.replace("\\040", " ").into())
    });
    lines.collect()
}

#[cfg(test)]
mod tests;
