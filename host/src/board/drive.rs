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
mod tests {
    use super::*;

    /// Puts the information of a boot loader into a folder.
    fn boot_loader(folder: &Path, id: &str) {
        let info = format!(
            "UF2 Bootloader 0.6.1 lib/nrfx (v2.0.0)\r\nModel: a board\r\nBoard-ID: {id}\r\nDate: Nov 30 2021\r\n"
        );
        fs::write(folder.join(INFO), info).unwrap();
    }

    const IDS: [(&str, Option<&str>); 7] = [
        ("nRF52840-SeeedXiao-v1", Some("xiao")),
        ("nRF52840-SeeedXiaoSense-v1", Some("xiao")),
        ("Seeed_XIAO_nRF52840_Sense", Some("xiao")),
        ("nRF52840-Feather-revE", Some("feather")),
        ("nRF52840-Feather-Sense", Some("feather")),
        ("nRF52840-nicenano", Some("nice-nano")),
        ("nRF52840-CircuitPlayground-revD", None),
    ];

    #[test]
    fn a_drive_tells_its_board() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Drive::at(folder.path()), None);
        for (id, image) in IDS {
            boot_loader(folder.path(), id);
            let drive = Drive::at(folder.path()).unwrap();
            assert_eq!(drive.board.map(|board| board.image), image, "{id}");
            assert_eq!(drive.id, id);
        }
        fs::write(folder.path().join(INFO), "no board").unwrap();
        assert_eq!(Drive::at(folder.path()), None);
    }

    #[test]
    fn of_two_drives_the_one_of_the_board_is_taken_and_none_of_two_alike() {
        let [one, other, empty] = [(); 3].map(|()| tempfile::tempdir().unwrap());
        boot_loader(one.path(), "nRF52840-SeeedXiao-v1");
        boot_loader(other.path(), "nRF52840-nicenano");
        let folders = || [&one, &other, &empty].map(|folder| folder.path().to_owned());
        let chosen = |board| Drive::among(folders(), board);
        let refused = chosen(None).unwrap_err();
        assert!(
            matches!(&refused, FlashError::Drives { paths } if paths.len() == 2),
            "{refused}"
        );
        let nano = chosen(UsbBoard::with_image("nice-nano")).unwrap();
        assert_eq!(nano.unwrap().path, other.path());
        boot_loader(other.path(), "nRF52840-SeeedXiaoSense-v1");
        let refused = chosen(UsbBoard::with_image("xiao")).unwrap_err();
        assert!(matches!(refused, FlashError::Drives { .. }), "{refused}");
        assert_eq!(Drive::among([empty.path().to_owned()], None).unwrap(), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_drive_and_one_that_cannot_be_written_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        boot_loader(folder.path(), "nRF52840-nicenano");
        let drive = Drive::at(folder.path()).unwrap();
        drive.write(&[1; 512]).unwrap();
        assert_eq!(fs::read(folder.path().join(WRITTEN)).unwrap(), [1; 512]);
        fs::remove_file(folder.path().join(WRITTEN)).unwrap();
        std::os::unix::fs::symlink("/dev/full", folder.path().join(WRITTEN)).unwrap();
        let full = drive.write(&[1; 512]).unwrap_err();
        assert!(matches!(full, FlashError::Full { .. }), "{full}");
        fs::remove_file(folder.path().join(WRITTEN)).unwrap();
        fs::create_dir(folder.path().join(WRITTEN)).unwrap();
        let refused = drive.write(&[1; 512]).unwrap_err();
        assert!(
            matches!(refused, FlashError::Unwritable { .. }),
            "{refused}"
        );
    }

    #[test]
    fn only_fat_is_looked_at() {
        let mounts = "/dev/sda1 / ext4 rw 0 0\nserver:/home /home nfs rw 0 0\n\
            /dev/sdb /media/me/XIAO\\040BOOT vfat rw,nosuid 0 0\nbroken\n";
        assert_eq!(fat(mounts), [PathBuf::from("/media/me/XIAO BOOT")]);
    }
}
