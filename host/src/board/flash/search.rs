//! A board with USB: its drive found, or its boot loader started by its port, and its first answer waited for.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use shared::uart_line::answer::Answer;
use shared::uart_line::command::Command;

use super::{Content, FlashError, UsbBoard};
use crate::board::drive::{Drive, mounted};
use crate::board::port::touch;
use crate::board::{Board, BoardError, usb};

/// Longest time until the drive is mounted, and then until the new firmware answers.
pub const PATIENCE: Duration = Duration::from_secs(30);
/// Pause between two looks.
pub(super) const AGAIN: Duration = Duration::from_millis(200);
/// Time in which the system gives a port that has just appeared its permissions.
const NEW: Duration = Duration::from_secs(2);
/// Where a board is looked for.
#[derive(Clone, Debug)]
pub struct Search {
    /// Folder of its drive; mounted ones are searched if absent.
    pub drive: Option<PathBuf>,
    /// Serial port of the board; those of this computer are searched if absent.
    pub port: Option<PathBuf>,
    /// The board, of several.
    pub board: Option<UsbBoard>,
    /// Longest time to wait for the drive, and then for the firmware.
    pub patience: Duration,
}

impl Search {
    /// Finds the drive. Without one, starts the boot loader of the board on a port, which `starts` is told, and waits.
    pub fn drive(&self, starts: impl FnOnce(&Path)) -> Result<Drive, FlashError> {
        match self.port.as_deref().map(Board::open) {
            // The board may be in its boot loader. What else is wrong with the port stays so.
            Some(Err(BoardError::Open { source, .. })) if source.kind() == ErrorKind::NotFound => {}
            Some(Err(error)) => return Err(error.into()),
            Some(Ok(_)) | None => {}
        }
        let look = || {
            let folders = self
                .drive
                .as_ref()
                .map_or_else(mounted, |path| vec![path.clone()]);
            Drive::among(folders, self.board)
        };
        if let Some(drive) = look()? {
            return Ok(drive);
        }
        let port = match &self.port {
            Some(port) => port.clone(),
            None => self.running()?,
        };
        starts(&port);
        touch(&port).map_err(|source| BoardError::Open { path: port, source })?;
        self.poll(look)?.ok_or(FlashError::NoDrive)
    }

    /// The first port on which a board answers.
    fn running(&self) -> Result<PathBuf, FlashError> {
        let mut closed = None;
        for port in self.ports() {
            match runs(&port) {
                Ok(Some(_)) => return Ok(port),
                Ok(None) => {}
                Err(error) => closed = Some(error),
            }
        }
        Err(match (closed, &self.drive) {
            (Some(error), _) => error.into(),
            (None, Some(path)) => FlashError::NoDriveAt { path: path.clone() },
            (None, None) => FlashError::NoBoard,
        })
    }

    /// Waits until the board runs what was copied; returns its port.
    pub fn started(&self, content: &Content, board: UsbBoard) -> Result<PathBuf, FlashError> {
        let expected = Running {
            image: board.image.to_owned(),
            model: content.model,
        };
        let (mut other, mut closed, mut since) = (None, None, None);
        let port = self.poll(|| {
            let ports = self.ports();
            let is_only = ports.len() == 1;
            for port in ports {
                match runs(&port) {
                    Ok(Some(found)) if found.is(&expected) => return Ok(Some(port)),
                    Ok(found) => other = found.or(other.take()),
                    Err(error) => {
                        let since: &Instant = since.get_or_insert_with(Instant::now);
                        if is_only && since.elapsed() > NEW {
                            return Err(error.into());
                        }
                        closed = Some(error);
                    }
                }
            }
            Ok(None)
        })?;
        port.ok_or_else(|| match (other, closed) {
            (None, None) => FlashError::Silent,
            (None, Some(error)) => error.into(),
            (Some(found), _) if found.image == expected.image && found.model.is_none() => {
                FlashError::NoModel
            }
            (Some(found), _) => FlashError::OtherContent {
                expected: expected.to_string(),
                found: found.to_string(),
            },
        })
    }

    /// Looks again and again while there is time.
    fn poll<T>(
        &self,
        mut look: impl FnMut() -> Result<Option<T>, FlashError>,
    ) -> Result<Option<T>, FlashError> {
        let end = Instant::now() + self.patience;
        loop {
            let found = look()?;
            if found.is_some() || Instant::now() >= end {
                return Ok(found);
            }
            std::thread::sleep(AGAIN);
        }
    }

    /// The port that is given, or those of boards with USB.
    fn ports(&self) -> Vec<PathBuf> {
        if let Some(port) = &self.port {
            return vec![port.clone()];
        }
        usb::ports()
    }
}

/// Image and model that a board runs.
struct Running {
    image: String,
    /// CRC-32 of the model file.
    model: Option<u32>,
}

impl Running {
    /// Whether a board runs what is expected: without a model in the file, whichever it has.
    fn is(&self, expected: &Self) -> bool {
        let has_model =
            self.model.is_some() && (self.model == expected.model || expected.model.is_none());
        self.image == expected.image && has_model
    }
}

/// Asks the board on a port; `None` without an answer.
fn runs(port: &Path) -> Result<Option<Running>, BoardError> {
    let read = |answer: &Answer<'_>| match answer {
        Answer::Identity(identity) => Some(Running {
            image: identity.image.to_owned(),
            model: identity.model,
        }),
        _ => None,
    };
    let asked = Board::open(port).and_then(|mut board| board.ask(Command::Identify, read));
    match asked {
        Err(BoardError::Open { path, source })
            if matches!(
                source.kind(),
                ErrorKind::PermissionDenied | ErrorKind::ResourceBusy
            ) =>
        {
            Err(BoardError::Open { path, source })
        }
        asked => Ok(asked.ok()),
    }
}

impl fmt::Display for Running {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "image {}", self.image)?;
        match self.model {
            Some(model) => write!(f, " with model {model:08x}"),
            None => f.write_str(" without a model"),
        }
    }
}
