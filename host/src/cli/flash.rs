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
use crate::board::flash::{BOARDS, Content, PATIENCE, Search, UsbBoard};
use crate::board::{Board, BoardError};
use execution::bounded_read;
use execution::run_folder::write_whole;

/// Maximum size of a UF2 file in bytes: twice what such a file may fill of flash.
const UF2_BYTES: u64 = 4 << 20;

/// Arguments of `flash`.
#[derive(Debug, Args)]
#[command(
    after_help = "The file for a board is among those of a release: xiao.uf2, feather.uf2, nice-nano.uf2; `cargo xtask uf2` builds it.\n\
    Press reset twice, quickly, and the board shows its drive. A board that runs this firmware needs no button.\n\
    The armband that a board is bound to stays.\n\n\
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
    /// Folder of the boot loader's drive, where it is not found.
    #[arg(long, value_name = "DIR")]
    drive: Option<PathBuf>,
    /// Serial port of the board: starts its boot loader if there is no drive, and is where the firmware is waited for.
    #[arg(long, value_name = "PATH")]
    port: Option<PathBuf>,
    /// UF2 file to write, in place of a board; there must be none of this name.
    #[arg(long, value_name = "FILE.uf2", conflicts_with_all = ["drive", "port", "board"])]
    out: Option<PathBuf>,
}

/// Copies firmware, model or both, waits for the board and binds an armband.
///
/// # Errors
/// When there is no board or not the right one, a file is refused, or the board does not run what was copied.
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
    let search = Search {
        drive: arguments.drive.clone(),
        port: arguments.port.clone(),
        board: arguments.board.as_deref().and_then(UsbBoard::with_image),
        patience: PATIENCE,
    };
    let drive = search.drive(|port| {
        let port = port.display();
        execution::progress::log(&format!(
            "{port}: starts the boot loader, waits for its drive"
        ));
    })?;
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
    writeln!(out, "copies these; the board then starts, bound as before")?;
    drive.write(&content.file())?;
    let port = search.started(&content, board)?;
    writeln!(out, "runs      on {}", port.display())?;
    bind(&port)?;
    write!(out, "next:     myointent live --port {}", port.display())?;
    match &arguments.model {
        Some(model) => writeln!(out, " --model {}", model.display())?,
        None => writeln!(out)?,
    }
    Ok(())
}

impl Arguments {
    /// Firmware and model that are put onto the board; none if neither is given.
    fn content(&self) -> anyhow::Result<Option<Content>> {
        let firmware = match &self.firmware {
            Some(path) => {
                let bytes = bounded_read::read(path, UF2_BYTES);
                Some((
                    path.as_path(),
                    bytes.with_context(|| path.display().to_string())?,
                ))
            }
            None => None,
        };
        let model = self.model.as_deref().map(read_model).transpose()?;
        if firmware.is_none() && model.is_none() {
            return Ok(None);
        }
        let firmware = firmware.as_ref().map(|(path, bytes)| (*path, &bytes[..]));
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

/// Asks whom the board follows.
fn following(board: &mut Board) -> Result<Following, BoardError> {
    board.ask(Command::Bind(BindCommand::State), |answer| match answer {
        Answer::Binding(binding) => Some(binding.following),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use crate::cli::Cli;
    use clap::Parser as _;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_new_board_gets_firmware_and_an_armband_and_later_another_model_and_keeps_the_armband() {
        use super::{Answer, Board, Command, Following, following, run};
        use crate::board::ModelFile;
        use crate::board::flash::tests::{Fake, PROGRAM_TEXT, image};

        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("xiao.uf2");
        std::fs::write(&file, image(PROGRAM_TEXT)).unwrap();
        let fake = Fake::start("xiao");
        let search = fake.search();
        let mut arguments = super::Arguments {
            firmware: Some(file),
            model: None,
            board: None,
            drive: search.drive,
            port: search.port.clone(),
            out: None,
        };
        let port = search.port.unwrap();
        let mut before = None;
        for own in ["../models/three-class.intent", "../models/six-class.intent"] {
            run(&arguments).unwrap();
            let mut board = Board::open(&port).unwrap();
            let following = following(&mut board).unwrap();
            assert!(matches!(following, Following::Bound(_)), "{following:?}");
            assert!(
                before
                    .replace(following)
                    .is_none_or(|before| before == following)
            );
            let running = board.ask(Command::Identify, |answer| match answer {
                Answer::Identity(identity) => identity.model,
                _ => None,
            });
            let expected = ModelFile::new(&std::fs::read(own).unwrap())
                .unwrap()
                .checksum();
            assert_eq!(running.unwrap(), expected);
            arguments.firmware = None;
            arguments.model = Some("../models/six-class.intent".into());
        }
        // Without a file: the drive is found, and its file is named.
        (arguments.model, arguments.board) = (None, Some("xiao".to_owned()));
        let error = run(&arguments).unwrap_err().to_string();
        assert!(error.contains("xiao.uf2"), "{error}");
    }

    #[test]
    fn a_file_is_written_or_a_board_is_flashed() {
        let refused = |line: &[&str]| {
            let line = ["myointent", "flash"].iter().chain(line);
            Cli::try_parse_from(line).unwrap_err().to_string()
        };
        let both = refused(&["--model", "x", "--out", "y", "--port", "z"]);
        assert!(both.contains("cannot be used with"), "{both}");
        let other = refused(&["--board", "uno"]);
        assert!(other.contains("xiao, feather, nice-nano"), "{other}");
    }
}
