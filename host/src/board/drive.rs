//! Drive of a boot loader for UF2 files: found, told by its board, written.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use execution::bounded_read;

use super::flash::{FlashError, UsbBoard};

/// File in which a boot loader says what board it is on. Source: github.com/microsoft/uf2, README.
const INFO: &str = "INFO_UF2.TXT";
/// First version of the boot loader that writes all of a program; older ones leave what is below 0x26000 as it is.
pub(super) const FIRST: (u32, u32) = (0, 4);
/// Name of the file that is written; the boot loader takes any.
const WRITTEN: &str = "FIRMWARE.UF2";
/// Bytes of the information that are read: a boot loader's file is one sector.
const INFO_BYTES: u64 = 4096;

/// Drive of a board that waits for a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Drive {
    /// Folder at which it is mounted.
    pub path: PathBuf,
    /// Board; `None` if there is no firmware for it.
    pub board: Option<UsbBoard>,
    /// `Board-ID` of the boot loader.
    pub id: String,
    /// Version of the boot loader, such as 0.6.1; empty if it does not say one.
    pub version: String,
}

impl Drive {
    /// The drive at a folder; `None` if the folder is not a board's drive.
    pub fn at(path: &Path) -> Option<Self> {
        let read = |name: &str| bounded_read::read(&path.join(name), INFO_BYTES).ok();
        // Some systems show the names of a FAT drive in small letters.
        let info = read(INFO).or_else(|| read(&INFO.to_ascii_lowercase()))?;
        let info = String::from_utf8_lossy(&info);
        let said = |key: &str| {
            let mut lines = info.split(['\r', '\n']);
            lines.find_map(|line| behind(line.trim(), key))
        };
        let id = said("Board-ID:")?.trim();
        let version = said("UF2 Bootloader").unwrap_or_default();
        let version = version.trim_start_matches([' ', ':', 'v', 'V']);
        Some(Self {
            path: path.to_owned(),
            board: UsbBoard::with_id(id),
            id: id.to_owned(),
            version: version.split(' ').next().unwrap_or_default().to_owned(),
        })
    }

    /// Whether the boot loader writes all of a program; none if its version is not known.
    pub fn is_recent(&self) -> Option<bool> {
        let (major, rest) = self.version.split_once('.')?;
        let minor = rest.split(|letter: char| !letter.is_ascii_digit()).next()?;
        Some((major.parse().ok()?, minor.parse().ok()?) >= FIRST)
    }

    /// The drive of a clone that has the pins of `board`.
    pub fn with_pins_of(self, board: UsbBoard) -> Result<Self, FlashError> {
        match self.board {
            Some(known) if known != board => Err(FlashError::other(&self, board.name)),
            _ => Ok(Self {
                board: Some(board),
                ..self
            }),
        }
    }

    /// The only drive among folders, or the only one of a board that is asked for, if any.
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
    pub fn write(&self, file: &[u8]) -> Result<(), FlashError> {
        let path = self.path.join(WRITTEN);
        let written = created(&path).and_then(|out| copy(out, file));
        written.map_err(|source| FlashError::unwritten(path, source))
    }
}

/// The rest of a line behind a key, in whatever case.
fn behind<'l>(line: &'l str, key: &str) -> Option<&'l str> {
    let (start, rest) = line.split_at_checked(key.len())?;
    start.eq_ignore_ascii_case(key).then_some(rest)
}

/// A new file, in place of an earlier one. A link is not followed, and a pipe, whose opening waits, is not opened.
fn created(path: &Path) -> io::Result<File> {
    match path.symlink_metadata() {
        Ok(earlier) => {
            bounded_read::regular(earlier.file_type())?;
            fs::remove_file(path)?;
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    File::create_new(path)
}

fn copy(mut out: File, file: &[u8]) -> io::Result<()> {
    out.write_all(file)?;
    // The board starts with the last block, and its drive may go before the system is done: what it runs says whether it has
    // all.
    let _ = out.sync_all();
    Ok(())
}

/// Folders at which drives may be mounted.
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
