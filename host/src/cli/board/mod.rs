//! `myointent board`: one command to a board on a serial port.

mod calibrate;
mod hid;
mod lock;
mod words;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use clap::{Args, Subcommand};
use shared::myo::{Address, Following};
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::smoother::{Gate, Reaction};
use shared::uart_line::alignment::AlignmentState;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::gate::GateCommand;

use self::words::{bound, charged, counted, identified, placed, why};
use crate::board::{self, Board, BoardError, ModelFile};
use crate::cli::arguments::mirrored;
use crate::cli::gate::reaction;
use crate::cli::read_model;
use crate::live::no_port;
use execution::progress;

/// Longest time to wait for an alignment or a pairing, which takes at most 30 s.
const PATIENCE: Duration = Duration::from_secs(35);
/// Pause between two checks whether a pairing is over.
const AGAIN: Duration = Duration::from_secs(1);

#[derive(Debug, Args)]
#[command(
    after_help = "The board's serial port is one USB cable away on the development kits. Close other programs that read it.\n\n\
    Examples:\n  myointent board --port /dev/ttyACM0 identify\n  \
    myointent board --port /dev/ttyACM0 bind begin            the strongest armband of the next 30 s\n  \
    myointent board --port /dev/ttyACM0 align begin           open the hand twice, with rest before and after\n  \
    myointent board --port /dev/ttyACM0 calibrate begin       do what it says for half a minute\n  \
    myointent board --port COM3 gate --reaction steady        fewer false activations, until the next start\n  \
    myointent board --port /dev/ttyACM0 lock on               no label until the hand is held open for 1.5 s\n  \
    myointent board --port /dev/ttyACM0 hid set close key:space    then hid on: the computer sees a keyboard\n  \
    myointent board --port /dev/ttyACM0 install my.intent     a new model, 20 s; after a break, again: it goes on"
)]
pub struct Arguments {
    /// The board's serial port, such as /dev/ttyACM0 or COM3, or a pseudo-terminal.
    #[arg(long, value_name = "PATH")]
    port: PathBuf,
    #[command(subcommand)]
    request: Request,
}

#[derive(Debug, Subcommand)]
enum Request {
    /// Say what runs there: program, model, armband, batteries.
    Identify,
    /// Say what was lost and dropped since its start.
    Counters,
    /// Begin, cancel or set an alignment to how the armband is worn.
    #[command(subcommand)]
    Align(Align),
    /// Bind an armband, forget it, or say which one is followed.
    #[command(subcommand)]
    Bind(Bind),
    /// Learn the wearer's last layer on the board, in half a minute, or forget it.
    #[command(subcommand)]
    Calibrate(calibrate::CalibrateRequest),
    /// Put a model on the board in place of its own, and in use. Outputs are safe meanwhile.
    Install {
        /// Model file.
        #[arg(value_name = "FILE.intent")]
        model: PathBuf,
    },
    /// Move the operating point until the next start; without options, say which is in force.
    Gate(GateChange),
    /// Lock labels until the hand is held open, until the next start.
    #[command(subcommand)]
    Lock(lock::LockRequest),
    /// Press keys and buttons of the computer that a board with USB is plugged into; kept over restarts.
    #[command(subcommand)]
    Hid(hid::HidRequest),
    /// Write the strength of the contraction behind each label, 0 to 100, until the next start.
    Strength {
        /// on or off.
        #[arg(value_name = "on|off", value_parser = ["on", "off"])]
        switch: String,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, Default, Debug, Args)]
struct GateChange {
    /// How soon a label changes: `fast`, `balanced`, `steady` or `late`; `model`: as the model file says.
    #[arg(long, value_name = "REACTION", value_parser = reaction_or_model)]
    reaction: Option<OrModel<Reaction>>,
    /// By how much the mean logit of a class has to exceed that of every other one, 0 to 50; `model`: as the model file
    /// says.
    #[arg(long, value_name = "MARGIN", value_parser = margin)]
    entry: Option<OrModel<i16>>,
    /// By how much it has to exceed that of movement outside the vocabulary, -50 to 50; `model`: as the model file says.
    #[arg(long, value_name = "MARGIN", value_parser = margin, allow_negative_numbers = true)]
    other: Option<OrModel<i16>>,
}

#[derive(Debug, Subcommand)]
enum Align {
    /// Begin one, as the button does, and wait for its result.
    Begin {
        /// Tell whether the armband is on the other arm than in training, 0 or 1, instead of having it found.
        #[arg(long, value_name = "0|1", value_parser = mirrored)]
        mirrored: Option<Arm>,
    },
    /// End the one in progress.
    Cancel,
    /// Put one in force that is known.
    Set {
        /// Places that the armband is turned by, 0 to 7.
        #[arg(value_parser = clap::value_parser!(u8).range(0..8))]
        turn: u8,
        /// On the other arm.
        #[arg(long)]
        mirrored: bool,
    },
    /// Take back whatever is in force: each electrode counts as in training.
    Reset,
    /// Say which one is in force.
    State,
}

#[derive(Debug, Subcommand)]
pub(super) enum Bind {
    /// Bind the armband with the strongest signal of the next 30 s.
    Begin,
    /// Bind the one with this address.
    Set {
        /// Such as FA:12:34:56:78:9A.
        #[arg(value_parser = |text: &str| Address::parse(text).map_err(|error| error.to_string()))]
        address: Address,
    },
    /// Bind none.
    Forget,
    /// Say which one is followed.
    State,
}

/// Part of an operating point; none for the model file's.
type OrModel<T> = Option<T>;

fn reaction_or_model(text: &str) -> Result<OrModel<Reaction>, String> {
    match text {
        "model" => Ok(None),
        name => reaction(name).map(Some),
    }
}

/// Reads a margin in hundredths of a logit.
fn margin(text: &str) -> Result<OrModel<i16>, String> {
    if text == "model" {
        return Ok(None);
    }
    let margin: f32 = text.parse().map_err(|_| "a number, or `model`")?;
    if !(-50.0..=50.0).contains(&margin) {
        return Err("-50 to 50, or `model`".to_owned());
    }
    #[expect(clippy::cast_possible_truncation, reason = "at most 5000")]
    Ok(Some((margin * 100.0).round() as i16))
}

/// Sends the command to the board and prints its answer.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let port = &arguments.port;
    let open = || Board::open(port).map_err(advised);
    let said = match &arguments.request {
        // Opens the port itself, repeatedly.
        Request::Install { model } => return run_install(port, model),
        Request::Align(align) => return run_align(&mut open()?, align),
        Request::Calibrate(request) => return calibrate::run(&mut open()?, *request),
        Request::Bind(bind) => return run_bind(&mut open()?, bind),
        Request::Gate(change) => run_gate(&mut open()?, *change)?,
        Request::Lock(request) => lock::run(&mut open()?, *request)?,
        Request::Hid(request) => hid::run(&mut open()?, *request)?,
        Request::Identify => {
            let mut board = open()?;
            let said = board.ask(Command::Identify, |answer| match answer {
                Answer::Identity(identity) => Some(identified(identity)),
                _ => None,
            })?;
            let head = match calibrate::is_in_use(&mut board)? {
                Some(true) => "head      calibrated by its wearer\n",
                Some(false) => "head      the model's own\n",
                None => "",
            };
            said + head + &board.battery()?.map_or_else(String::new, charged)
        }
        Request::Counters => open()?.ask(Command::Counters, |answer| match answer {
            Answer::Counts(counts) => Some(counted(counts)),
            _ => None,
        })?,
        Request::Strength { switch } => {
            let said = open()?.ask(Command::Strength(switch == "on"), |answer| match answer {
                Answer::Strength(true) => Some("lines have the strength until the next start\n"),
                Answer::Strength(false) => Some("lines do not have the strength\n"),
                _ => None,
            })?;
            said.to_owned()
        }
    };
    write!(std::io::stdout(), "{said}")?;
    Ok(())
}

/// A port that cannot be opened, with what helps; any other error as it is.
pub(super) fn advised(error: BoardError) -> anyhow::Error {
    match error {
        BoardError::Open { path, source } => anyhow::Error::msg(no_port(&source, &path)),
        error => error.into(),
    }
}

fn run_install(port: &Path, path: &Path) -> anyhow::Result<()> {
    let bytes = read_model(path)?;
    let file = ModelFile::new(&bytes).with_context(|| path.display().to_string())?;
    let bar = progress::bar(file.blocks() as usize, "install");
    let installed = board::install(
        port,
        file,
        || false,
        |blocks| bar.set_position(blocks.into()),
    );
    bar.finish_and_clear();
    installed
        .map_err(advised)
        .context("not installed: the same command goes on where this one ended")?;
    let checksum = file.checksum();
    writeln!(
        std::io::stdout(),
        "installed and in use: model {checksum:08x}"
    )?;
    Ok(())
}

fn run_align(board: &mut Board, align: &Align) -> anyhow::Result<()> {
    let command = match *align {
        Align::Begin { mirrored } => AlignCommand::Begin(mirrored.unwrap_or_default()),
        Align::Cancel => AlignCommand::Cancel,
        Align::Set { turn, mirrored } => AlignCommand::Set(Alignment::new(turn, mirrored)),
        Align::Reset => AlignCommand::Set(Alignment::NONE),
        Align::State => {
            writeln!(std::io::stdout(), "{}", placed(in_force(board)?))?;
            return Ok(());
        }
    };
    let accepted = |answer: &Answer<'_>| matches!(answer, Answer::Align(_)).then_some(());
    board.ask(Command::Align(command), accepted)?;
    let mut out = std::io::stdout();
    if let AlignCommand::Set(wanted) = command {
        // The answer does not say which alignment is set.
        let found = in_force(board)?;
        if found != wanted {
            let (wanted, found) = (placed(wanted), placed(found));
            bail!("expected `{wanted}` in force, found `{found}`: set it again");
        }
    }
    if !matches!(command, AlignCommand::Begin(_)) {
        writeln!(out, "done")?;
        return Ok(());
    }
    writeln!(out, "open the hand twice, with rest before and after")?;
    let Some(result) = board.aligned(PATIENCE)? else {
        bail!("the board did not report the result of the alignment");
    };
    match result.state {
        AlignmentState::Aligned => {
            writeln!(out, "aligned: {}", placed(result.alignment))?;
            Ok(())
        }
        state => bail!("not aligned, nothing has changed: {}", why(state)),
    }
}

fn in_force(board: &mut Board) -> Result<Alignment, BoardError> {
    let state = Command::Align(AlignCommand::State);
    board.ask(state, |answer| match answer {
        Answer::Alignment(alignment) => Some(*alignment),
        _ => None,
    })
}

pub(super) fn run_bind(board: &mut Board, bind: &Bind) -> anyhow::Result<()> {
    let command = match *bind {
        Bind::Begin => BindCommand::Begin,
        Bind::Set { address } => BindCommand::Set(address),
        Bind::Forget => BindCommand::Forget,
        Bind::State => BindCommand::State,
    };
    let read = |answer: &Answer<'_>| match answer {
        Answer::Binding(binding) => Some(*binding),
        _ => None,
    };
    let mut out = std::io::stdout();
    board.has_heard_nobody = false;
    let mut binding = board.ask(Command::Bind(command), read)?;
    if !matches!(bind, Bind::Begin) {
        writeln!(out, "{}", bound(binding))?;
        return Ok(());
    }
    let end = Instant::now() + PATIENCE;
    writeln!(out, "pairing: wear the armband close to the board for 30 s")?;
    while binding.following == Following::Pairing && Instant::now() < end {
        std::thread::sleep(AGAIN);
        binding = board.ask(Command::Bind(BindCommand::State), read)?;
    }
    let has_armband = matches!(
        binding.following,
        Following::Bound(_) | Following::Pinned(_)
    );
    if board.has_heard_nobody || !has_armband {
        bail!(
            "no armband was heard, and the binding is as before: {}. Put the armband on, move the hand to wake it, stay close to the \
             board, quit Myo Connect on computers nearby, and try again: `myointent board --port PORT bind begin`",
            bound(binding)
        );
    }
    writeln!(out, "{}", bound(binding))?;
    Ok(())
}

fn run_gate(board: &mut Board, change: GateChange) -> anyhow::Result<String> {
    let read = |answer: &Answer<'_>| match answer {
        Answer::Gate(gate) => Some(*gate),
        _ => None,
    };
    let mut gate = board.ask(Command::Gate(GateCommand::State), read)?;
    if change != GateChange::default() {
        let wanted = Gate {
            entry: change.entry.unwrap_or(gate.entry),
            other: change.other.unwrap_or(gate.other),
            reaction: change.reaction.unwrap_or(gate.reaction),
        };
        if wanted.entry.is_some_and(|entry| entry < 0) {
            bail!("--entry is 0 or more");
        }
        gate = board.ask(Command::Gate(GateCommand::Set(wanted)), read)?;
    }
    let shown =
        |value: Option<String>| value.unwrap_or_else(|| "as the model file says".to_owned());
    let margin = |hundredths: i16| format!("{:.2}", f32::from(hundredths) / 100.0);
    let reaction = shown(gate.reaction.map(|reaction| reaction.name().to_owned()));
    let [entry, other] = [gate.entry, gate.other].map(|hundredths| shown(hundredths.map(margin)));
    Ok(format!(
        "reaction  {reaction}\nentry     {entry}\nother     {other}\nuntil the next start; `myointent gate` changes a model file\n"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_that_is_not_there_is_named_with_those_that_are() {
        let model = "../models/three-class.intent".into();
        for request in [Request::Identify, Request::Install { model }] {
            let port = "/dev/no-such-board".into();
            let error = run(&Arguments { port, request }).unwrap_err();
            let error = format!("{error:#}");
            assert!(
                error.contains("there is no port /dev/no-such-board"),
                "{error}"
            );
            let named = ["Ports that exist", "No serial port"].map(|text| error.contains(text));
            assert_ne!(named, [false; 2], "{error}");
            assert!(!error.contains("os error"), "{error}");
        }
    }

    #[test]
    fn a_margin_is_a_number_of_hundredths_or_the_models() {
        assert_eq!(margin("1.5"), Ok(Some(150)));
        assert_eq!(margin("-0.5"), Ok(Some(-50)));
        assert_eq!(margin("model"), Ok(None));
        for wrong in ["51", "-50.1", "NaN", "inf", "x", ""] {
            assert!(margin(wrong).is_err(), "{wrong}");
        }
    }
}
