//! `myointent flash`: firmware and model onto a board with USB, by the drive of its boot loader.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use clap::builder::PossibleValuesParser;
use shared::myo::Following;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::{BindCommand, Command};

use super::board::{Bind, advised, run_bind};
use super::output::refuse_existing;
use super::read_model;
use crate::board::flash::{BOARDS, Content, FlashError, PATIENCE, Search, UsbBoard};
use crate::board::{Board, BoardError};
use execution::run_folder::write_whole;
use execution::{bounded_read, progress};

/// Maximum size of a UF2 file in bytes: twice what such a file may fill of flash.
const UF2_BYTES: u64 = 4 << 20;

#[derive(Debug, Args)]
#[command(
    after_help = "The file for a board is among those of a release: xiao.uf2, feather.uf2, nice-nano.uf2; `cargo xtask uf2` builds it.\n\
    Press reset twice, quickly, and the board shows its drive. A board that runs this firmware needs no button.\n\
    The armband that a board is bound to stays; exit code 1 if there is none in the end.\n\n\
    Examples:\n  myointent flash xiao.uf2                                what a new board needs: firmware and model\n  \
    myointent flash --model my.intent                       another model\n  \
    myointent flash --model my.intent --out my.uf2          a file to drag onto the drive"
)]
pub struct Arguments {
    /// Firmware for the board, with a model. Without it, the model alone is replaced.
    #[arg(value_name = "FILE.uf2")]
    firmware: Option<PathBuf>,
    /// Model file, in place of the one in the file of the firmware.
    #[arg(long, value_name = "FILE.intent")]
    model: Option<PathBuf>,
    /// The board, where several are connected.
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(BOARDS.map(|board| board.image)))]
    board: Option<String>,
    /// The board whose pins a clone has, where its boot loader names another one.
    #[arg(long = "as", value_name = "NAME", value_parser = PossibleValuesParser::new(BOARDS.map(|board| board.image)))]
    pins_of: Option<String>,
    /// Folder of the boot loader's drive, where it is not found.
    #[arg(long, value_name = "DIR")]
    drive: Option<PathBuf>,
    /// Serial port of the board: starts its boot loader if there is no drive, and is where the firmware is waited for.
    #[arg(long, value_name = "PATH")]
    port: Option<PathBuf>,
    /// UF2 file to write, in place of a board; it must not exist.
    #[arg(long, value_name = "FILE.uf2", conflicts_with_all = ["drive", "port", "board", "pins_of"])]
    out: Option<PathBuf>,
}

/// Copies firmware, model or both, waits for the board and binds an armband.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let content = arguments.content()?;
    let mut out = std::io::stdout();
    if let Some(path) = &arguments.out {
        let content = content.context("give firmware, --model or both")?;
        refuse_existing(path)?;
        write_whole(path, &content.file())?;
        writeln!(out, "{}", path.display())?;
        return Ok(());
    }
    let board = |name: &Option<String>| name.as_deref().and_then(UsbBoard::with_image);
    let search = Search {
        drive: arguments.drive.clone(),
        port: arguments.port.clone(),
        board: board(&arguments.board),
        patience: PATIENCE,
    };
    let starts = |port: &Path| {
        let port = port.display();
        progress::log(&format!(
            "{port}: starts the boot loader, waits for its drive"
        ));
    };
    let mut drive = search.drive(starts).map_err(told)?;
    if let Some(board) = board(&arguments.pins_of) {
        drive = drive.with_pins_of(board)?;
    }
    let Some(content) = content else {
        let all = BOARDS
            .map(|board| format!("{}.uf2", board.image))
            .join(", ");
        let file = drive
            .board
            .map_or(all, |board| format!("{}.uf2", board.image));
        bail!(
            "found {} ({}): give its file of a release, {file}, or --model",
            drive.path.display(),
            drive.id
        );
    };
    let board = content.fits(&drive, search.board)?;
    writeln!(
        out,
        "board     {}, drive {}",
        board.name,
        drive.path.display()
    )?;
    if let Some(firmware) = &content.firmware {
        writeln!(out, "firmware  {}", firmware.version)?;
    }
    if let Some(model) = content.model {
        writeln!(out, "model     {model:08x}")?;
    }
    if drive.is_recent().is_none() {
        progress::log(
            "warning: the version of the boot loader is not known; one older than 0.4 does not start this firmware: update it first",
        );
    }
    writeln!(out, "copies these; the board then starts, bound as before")?;
    drive.write(&content.file())?;
    let port = search.started(&content, board).map_err(told)?;
    writeln!(out, "runs      on {}", port.display())?;
    let bound = bind(&port);
    write!(out, "next:     myointent live --port {}", port.display())?;
    match &arguments.model {
        Some(model) => writeln!(out, " --model {}", model.display())?,
        None => writeln!(out)?,
    }
    bound.context("the board runs what was copied, and follows no armband yet")
}

/// An error, with what helps against a port that cannot be opened.
fn told(error: FlashError) -> anyhow::Error {
    match error {
        FlashError::Model(error) => advised(error),
        error => error.into(),
    }
}

impl Arguments {
    /// Firmware and model that are put onto the board; none if neither is given.
    fn content(&self) -> anyhow::Result<Option<Content>> {
        if self.firmware.is_none() && self.model.is_none() {
            return Ok(None);
        }
        let read = |path: &PathBuf| {
            let bytes = bounded_read::read(path, UF2_BYTES);
            bytes.with_context(|| path.display().to_string())
        };
        let bytes = self.firmware.as_ref().map(read).transpose()?;
        let model = self.model.as_deref().map(read_model).transpose()?;
        let firmware = self.firmware.as_deref().zip(bytes.as_deref());
        Ok(Some(Content::new(firmware, model.as_deref())?))
    }
}

/// Binds an armband, unless the board has one.
fn bind(port: &Path) -> anyhow::Result<()> {
    let mut board = Board::open(port).map_err(advised)?;
    let bind = match following(&mut board)? {
        Following::Nobody | Following::Pairing => Bind::Begin,
        _ => Bind::State,
    };
    run_bind(&mut board, &bind)
}

fn following(board: &mut Board) -> Result<Following, BoardError> {
    board.ask(Command::Bind(BindCommand::State), |answer| match answer {
        Answer::Binding(binding) => Some(binding.following),
        _ => None,
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests;
