//! Firmware and model for a board with USB: what a file holds, and which board it is for.

mod search;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use shared::uf2::{MODEL_REGION, PROGRAM_REGION, Uf2, Uf2Error};

use super::drive::{Drive, FIRST};
use super::{BoardError, InstallError, ModelFile};
pub use search::{PATIENCE, Search};

/// Board with USB that there is firmware for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct UsbBoard {
    /// Name of its image, of `--board`, and of the file of a release.
    pub image: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Values of its boot loader's `Board-ID`. Source: board.h of each board in Adafruit_nRF52_Bootloader.
    ids: &'static [&'static str],
}

/// All of them.
pub const BOARDS: [UsbBoard; 3] = [
    UsbBoard {
        image: "xiao",
        name: "XIAO nRF52840",
        ids: &[
            "nRF52840-SeeedXiao-v1",
            "nRF52840-SeeedXiaoSense-v1",
            "Seeed_XIAO_nRF52840",
            "Seeed_XIAO_nRF52840_Sense",
        ],
    },
    UsbBoard {
        image: "feather",
        name: "Feather nRF52840",
        ids: &[
            "nRF52840-Feather-revD",
            "nRF52840-Feather-revE",
            "nRF52840-Feather-Sense",
        ],
    },
    UsbBoard {
        image: "nice-nano",
        name: "nice!nano 2",
        ids: &["nRF52840-nicenano"],
    },
];

impl UsbBoard {
    /// The board of an image.
    pub fn with_image(image: &str) -> Option<Self> {
        BOARDS.into_iter().find(|board| board.image == image)
    }

    /// The board of a boot loader.
    pub(super) fn with_id(id: &str) -> Option<Self> {
        let is_its = |board: &Self| board.ids.iter().any(|own| id.eq_ignore_ascii_case(own));
        BOARDS.into_iter().find(is_its)
    }
}

/// Error of putting firmware or a model onto a board with USB.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum FlashError {
    #[error(
        "no board found. Plug one in, press reset twice, quickly, and wait for its drive (mount it where the system does \
         not), or give --drive or --port.\nWithout a board, buy a XIAO nRF52840, a Feather nRF52840 Express or a nice!nano 2, \
         a USB cable that carries data, and a Myo armband. To see labels, nothing else is wired; docs/guides/wire.md names \
         the pins for a hand"
    )]
    NoBoard,
    #[error(
        "{path}: expected the drive of a boot loader, with a Board-ID in its INFO_UF2.TXT, found none: press reset twice, quickly, \
         mount the drive, and give its folder"
    )]
    NoDriveAt { path: PathBuf },
    #[error("several drives of boot loaders: {}; unplug all but one board, or give --drive", listed(.paths))]
    Drives { paths: Vec<PathBuf> },
    #[error("{path}: expected the drive of {expected}, found Board-ID {id}: nothing was written{}", of_clones(.id))]
    OtherBoard {
        path: PathBuf,
        expected: String,
        id: String,
    },
    #[error(
        "{path}: expected a boot loader of version {}.{} or later, found {version}: nothing was written. Older ones do not write all \
         of the firmware: update it as the board's maker says, then try again", FIRST.0, FIRST.1
    )]
    OldBootLoader { path: PathBuf, version: String },
    #[error("{path}")]
    File {
        path: PathBuf,
        #[source]
        source: Uf2Error,
    },
    #[error(
        "{path}: expected firmware of this project, found another program: nothing was written"
    )]
    Foreign { path: PathBuf },
    #[error("{path}: its model is damaged: download the file again, or give a model with --model")]
    Held {
        path: PathBuf,
        #[source]
        source: InstallError,
    },
    #[error(transparent)]
    Model(#[from] BoardError),
    #[error(
        "{path}: the drive is full. Is it a boot loader's? Press reset twice, quickly, and try again"
    )]
    Full { path: PathBuf },
    #[error(
        "{path} cannot be written; if it is on a boot loader's drive, press reset twice, quickly, and try again"
    )]
    Unwritable {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error("no drive came within {} s: press reset twice, quickly, mount the drive, and try again", PATIENCE.as_secs())]
    NoDrive,
    #[error(
        "copied, but no board answers within {} s: press reset once; a boot loader older than 0.4 has to be updated first",
        PATIENCE.as_secs()
    )]
    Silent,
    #[error("copied, but the board has no model that it can run: give one with --model")]
    NoModel,
    #[error(
        "copied, but the board runs {found}, expected {expected}: press reset twice, quickly, and try again"
    )]
    OtherContent { expected: String, found: String },
}

impl FlashError {
    /// A drive that is not the one of a board with this name.
    pub(super) fn other(drive: &Drive, expected: &str) -> Self {
        Self::OtherBoard {
            path: drive.path.clone(),
            expected: expected.to_owned(),
            id: drive.id.clone(),
        }
    }

    /// A file that was not written to a drive.
    pub(super) fn unwritten(path: PathBuf, source: std::io::Error) -> Self {
        match source.kind() {
            ErrorKind::StorageFull => Self::Full { path },
            _ => Self::Unwritable { path, source },
        }
    }
}

/// Advice for a board whose `Board-ID` is not known.
fn of_clones(id: &str) -> &'static str {
    match UsbBoard::with_id(id) {
        Some(_) => "",
        None => {
            ". If it is an nRF52840 with the pins of one of these boards, say which: --as nice-nano"
        }
    }
}

fn listed(paths: &[PathBuf]) -> String {
    let paths: Vec<_> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    paths.join(", ")
}

/// Firmware and model that are put onto a board.
#[derive(Clone, Debug)]
pub struct Content {
    file: Uf2,
    /// Version, revision and board of the firmware; none without firmware.
    pub firmware: Option<Firmware>,
    /// CRC-32 of the model file; none without a model.
    pub model: Option<u32>,
}

/// Firmware in a file, by the first line that it writes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Firmware {
    /// Version and revision of the source.
    pub version: String,
    /// The board that it is built for.
    pub board: UsbBoard,
}

impl Firmware {
    /// Finds the text of the first line in a program.
    fn find(program: &[u8]) -> Option<Self> {
        const START: &[u8] = b"# myointent ";
        let starts = program.windows(START.len()).enumerate();
        let mut lines = starts
            .filter(|(_, text)| *text == START)
            .filter_map(|(at, _)| {
                let text = program[at + START.len()..]
                    .split(|byte| !byte.is_ascii_graphic() && *byte != b' ')
                    .next()?;
                let (version, rest) = str::from_utf8(text).ok()?.split_once(", image ")?;
                let (image, _) = rest.split_once(", model ")?;
                Some(Self {
                    version: version.to_owned(),
                    board: UsbBoard::with_image(image)?,
                })
            });
        lines.next()
    }
}

impl Content {
    /// Firmware from a file of a release with the model in it, a model in its place, or a model alone.
    pub fn new(image: Option<(&Path, &[u8])>, model: Option<&[u8]>) -> Result<Self, FlashError> {
        let (mut file, mut firmware) = (Uf2::default(), None);
        let path = image.map(|(path, _)| path.to_owned()).unwrap_or_default();
        if let Some((_, bytes)) = image {
            file = match Uf2::parse(bytes) {
                Ok(file) => file,
                Err(source) => return Err(FlashError::File { path, source }),
            };
            let program = file.bytes(PROGRAM_REGION);
            firmware = Firmware::find(&program);
            // `--out` writes a file of a model alone.
            let is_model = program.is_empty() && !file.bytes(MODEL_REGION).is_empty();
            if firmware.is_none() && !is_model {
                return Err(FlashError::Foreign { path });
            }
        }
        if let Some(model) = model {
            let checked = ModelFile::new(model).map_err(BoardError::from)?;
            file.put_model(checked.bytes()).map_err(|_| {
                BoardError::from(InstallError::Long {
                    length: model.len(),
                    room: MODEL_REGION.len(),
                })
            })?;
        }
        let held = file.bytes(MODEL_REGION);
        let model = match ModelFile::new(&held) {
            _ if held.is_empty() => None,
            Ok(model) => Some(model.checksum()),
            Err(source) => return Err(FlashError::Held { path, source }),
        };
        Ok(Self {
            file,
            firmware,
            model,
        })
    }

    /// The UF2 file.
    pub fn file(&self) -> Vec<u8> {
        self.file.file()
    }

    /// Checks that a drive is that of the board, and that its boot loader writes all of it.
    pub fn fits(&self, drive: &Drive, asked: Option<UsbBoard>) -> Result<UsbBoard, FlashError> {
        let of_file = self.firmware.as_ref().map(|firmware| firmware.board);
        let is_right = |board: &UsbBoard| {
            [of_file, asked]
                .into_iter()
                .flatten()
                .all(|one| one == *board)
        };
        let board = drive.board.filter(is_right).ok_or_else(|| {
            let all = BOARDS.map(|board| board.name).join(", ");
            FlashError::other(drive, of_file.or(asked).map_or(&all, |board| board.name))
        })?;
        if drive.is_recent() == Some(false) {
            return Err(FlashError::OldBootLoader {
                path: drive.path.clone(),
                version: drive.version.clone(),
            });
        }
        Ok(board)
    }
}

#[cfg(all(test, target_os = "linux"))]
pub(crate) mod tests;
