//! Installs a model on the board at a port, which is opened again after a break.

use std::path::Path;
use std::time::{Duration, Instant};

use shared::units::Millis;
use web::installer::{InstallError, Installer, ModelFile};

use super::{Board, BoardError, WAIT};

/// Pause between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(100);

/// Installs a model on the board at a port. `report` gets the number of blocks that the board has. A lost board is
/// searched for and the installation continues, until there was no progress for 30 s or for ten begins. It ends early
/// once `stopped` returns true. It succeeds once the board reports that it runs the model.
///
/// # Errors
/// There is no board, it refuses, it is lost or makes no progress, it runs another model in the end, or `stopped`
/// returned true. A new call continues where this one ended.
pub fn install(
    path: &Path,
    file: ModelFile<'_>,
    stopped: impl Fn() -> bool,
    mut report: impl FnMut(u32),
) -> Result<(), BoardError> {
    let began = Instant::now();
    #[expect(clippy::cast_possible_truncation, reason = "a wrapping clock")]
    let now = || Millis(began.elapsed().as_millis() as u32);
    let mut board = Board::open(path)?;
    let mut installer = Installer::new(file, now());
    let mut reported = None;
    loop {
        if stopped() {
            return Err(BoardError::Stopped);
        }
        if let Err(error) = board.exchange(&mut installer, now) {
            // Tries until the board is back or the time is over.
            board = loop {
                if !installer.resume(now()) {
                    return Err(error);
                }
                if stopped() {
                    return Err(BoardError::Stopped);
                }
                std::thread::sleep(AGAIN);
                if let Ok(board) = Board::open(path) {
                    break board;
                }
            };
        }
        if reported != installer.blocks() {
            reported = installer.blocks();
            report(reported.unwrap_or(0));
        }
        if let Some(end) = installer.end() {
            return end.clone().map_err(|error| match error {
                InstallError::Silent => BoardError::Silent {
                    path: path.to_owned(),
                },
                error => error.into(),
            });
        }
    }
}

impl Board {
    /// Sends the command that is due, and takes a line.
    fn exchange(
        &mut self,
        installer: &mut Installer,
        now: impl Fn() -> Millis,
    ) -> Result<(), BoardError> {
        if let Some(command) = installer.command(now()) {
            self.send(command)?;
        }
        self.wait(WAIT, |line| {
            installer.line(now(), line);
            Some(())
        })?;
        Ok(())
    }
}
