//! A board with USB: its drive found, or its boot loader started by its port, and its first answer waited for.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serial2::SerialPort;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::Command;

use super::{Content, FlashError, UsbBoard};
use crate::board::drive::{Drive, mounted};
use crate::board::{Board, BoardError};

/// Baud rate at which a port is opened and closed to start the boot loader.
pub(super) const TOUCH_BAUD: u32 = 1200;
/// Longest time until the drive is mounted, and then until the new firmware answers.
pub const PATIENCE: Duration = Duration::from_secs(30);
/// Pause between two looks.
pub(super) const AGAIN: Duration = Duration::from_millis(200);
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
    ///
    /// # Errors
    /// There is no board, there are several drives, or none comes.
    pub fn drive(&self, starts: impl FnOnce(&Path)) -> Result<Drive, FlashError> {
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
        let on_port = || self.ports().into_iter().find(|port| runs(port).is_some());
        let port = self
            .port
            .clone()
            .or_else(on_port)
            .ok_or(FlashError::NoBoard)?;
        starts(&port);
        touch(&port)?;
        self.poll(look)?.ok_or(FlashError::NoDrive)
    }

    /// Waits until the board runs what was copied; returns its port.
    ///
    /// # Errors
    /// [`FlashError::Silent`], [`FlashError::OtherContent`].
    pub fn started(&self, content: &Content, board: UsbBoard) -> Result<PathBuf, FlashError> {
        let expected = Running {
            image: board.image.to_owned(),
            model: content.model,
        };
        let mut other = None;
        let port = self.poll(|| {
            for port in self.ports() {
                match runs(&port) {
                    Some(found) if found == expected => return Ok(Some(port)),
                    found => other = found.or(other.take()),
                }
            }
            Ok(None)
        })?;
        port.ok_or_else(|| match other {
            None => FlashError::Silent,
            Some(found) => FlashError::OtherContent {
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

    /// The port that is given, or those of USB devices.
    fn ports(&self) -> Vec<PathBuf> {
        if let Some(port) = &self.port {
            return vec![port.clone()];
        }
        let mut ports = SerialPort::available_ports().unwrap_or_default();
        ports.retain(|port| {
            let name = port.to_string_lossy();
            ["ttyACM", "usbmodem", "COM"]
                .iter()
                .any(|part| name.contains(part))
        });
        ports
    }
}

/// Starts the boot loader of the board on a port, which looks for this baud rate when the port is closed.
fn touch(path: &Path) -> Result<(), BoardError> {
    let port = SerialPort::open(path, TOUCH_BAUD).map_err(|source| BoardError::Open {
        path: path.to_owned(),
        source,
    })?;
    // Fails on a pseudo-terminal; on the others, closing the port does the same.
    let _ = port.set_dtr(false);
    Ok(())
}

/// Image and model that a board runs.
#[derive(PartialEq, Eq)]
struct Running {
    image: String,
    /// CRC-32 of the model file.
    model: Option<u32>,
}

/// Asks the board on a port; none if none answers.
fn runs(port: &Path) -> Option<Running> {
    let read = |answer: &Answer<'_>| match answer {
        Answer::Identity(identity) => Some(Running {
            image: identity.image.to_owned(),
            model: identity.model,
        }),
        _ => None,
    };
    Board::open(port).ok()?.ask(Command::Identify, read).ok()
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
