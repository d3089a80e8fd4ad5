//! Commands that the device takes on the same UART: one ASCII line each.
//!
//! [`Command`]'s rows are the grammar; docs/uart.md says what they do. A line ends with CR, LF or both.
//!
//! Every line from `$` to its end is answered once, in order: [`answer`](super::answer). A line has at most 112 bytes without
//! its end. Bytes outside a line are ignored, `$` begins a line anew, and the device's own lines are no commands and not
//! answered: a receiver connected to the own transmitter must not talk to itself.
//!
//! ```text
//! $IDENTIFY*04
//! $ALIGN,set,3,0*00
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::calibration::CalibrateCommand;
use super::fields::{Fields, Reader, Rows, Writer, field, rows};
use super::frame::unframed;
use super::gate::GateCommand;
use super::hid::Gesture;
use super::lock::LockCommand;
use super::refusal::Refusal;
use crate::hid::{HidCommand, Output};
use crate::installation::{Block, Transfer};
use crate::myo::{Address, Following, MyoEvent};
use crate::stream::alignment::{Alignment, Arm};
use crate::stream::lock::LockTimes;
use crate::stream::smoother::Gate;

/// Most bytes of a command's line, without its end: a block's.
pub const MAX_COMMAND_BYTES: usize = 112;

/// The line that begins a pairing, for a text that tells a person to send it.
pub const BEGIN_PAIRING: &str = "$BIND,begin*4A\r\n";
/// Line of a pairing that has bound nobody, CR LF included.
pub const NOBODY_HEARD: &str = "# pairing over: no armband was heard\r\n";

/// Command to the device. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Command {
    /// Say what runs here.
    Identify,
    /// Say how the board's own battery is charged. Boards from before this command refuse its argument.
    Battery,
    /// Say what was lost and dropped.
    Counters,
    /// Begin, cancel or set an alignment.
    Align(AlignCommand),
    /// Write the samples too, or no longer, as after a start.
    Raw(bool),
    /// Write the movement too, over USB alone, or no longer, as after a start.
    Imu(bool),
    /// Write the strength behind labels and states too, or no longer, as after a start.
    Strength(bool),
    /// Begin a pairing, bind or forget an armband, or say which one is followed.
    Bind(BindCommand),
    /// Change the confidence gate, or say which one is in force.
    Gate(GateCommand),
    /// Lock or unlock the labels, or say whether they are locked.
    Lock(LockCommand),
    /// Change the outputs to a computer, or say which there are.
    Hid(HidCommand),
    /// Calibrate, use no calibration, or say how far one is.
    Calibrate(CalibrateCommand),
    /// Begin to exchange the model, or go on with it.
    Install(Transfer),
    /// Take a block of it, with this number.
    Block(u32, Block),
}

/// A command about the armband that is bound.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BindCommand {
    /// Begin a pairing.
    Begin,
    /// Bind this one.
    Set(Address),
    /// Bind none.
    Forget,
    /// Change nothing.
    State,
}

impl BindCommand {
    /// Event that carries it out; none where it changes nothing: binding an armband again would end its stream. `kept` is the
    /// armband that outlasts a restart.
    ///
    /// # Errors
    /// [`Refusal::BuiltIn`] where it cannot be changed.
    pub fn event(
        self,
        following: Following,
        kept: Option<Address>,
    ) -> Result<Option<MyoEvent<'static>>, Refusal> {
        let event = match self {
            Self::State => return Ok(None),
            Self::Begin => MyoEvent::Pair,
            Self::Set(armband) => MyoEvent::Bind(Some(armband)),
            Self::Forget => MyoEvent::Bind(None),
        };
        match following {
            Following::Pinned(_) => Err(Refusal::BuiltIn),
            Following::Bound(armband) if self == Self::Set(armband) && kept == Some(armband) => {
                Ok(None)
            }
            _ => Ok(Some(event)),
        }
    }
}

/// A command about the alignment.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AlignCommand {
    /// Begin one; where nothing is told of the arm, as the button does.
    Begin(Arm),
    /// End the one in progress; nothing changes.
    Cancel,
    /// Put this one in force.
    Set(Alignment),
    /// Say which one is in force.
    State,
}

impl Command {
    /// Reads a line without its end; `None` for a line that the device itself writes.
    ///
    /// # Errors
    /// The first thing that is wrong: frame, checksum, name, arguments.
    pub fn parse(line: &[u8]) -> Result<Option<Self>, Refusal> {
        let body = unframed(line).map_err(|error| match error {
            ParseError::Checksum { expected, .. } => Refusal::Checksum(expected),
            _ => Refusal::Frame,
        })?;
        if is_own(body) {
            return Ok(None);
        }
        Self::of_body(body).map(Some).map_err(|error| match error {
            ParseError::Field { field: "kind" } => Refusal::Unknown,
            ParseError::Field { field: "block" } => Refusal::Block,
            _ => Refusal::Arguments,
        })
    }
}

rows!(Command {
    "IDENTIFY" => Self::Identify,
    "IDENTIFY,battery" => Self::Battery,
    "COUNTERS" => Self::Counters,
    "ALIGN,begin" => Self::Align(AlignCommand::Begin(Arm::Unknown)),
    "ALIGN,begin" (mirrored: bool) => Self::Align(AlignCommand::Begin(Arm::Known { mirrored })),
    "ALIGN,cancel" => Self::Align(AlignCommand::Cancel),
    "ALIGN,set" (alignment: Alignment) => Self::Align(AlignCommand::Set(alignment)),
    "ALIGN,state" => Self::Align(AlignCommand::State),
    "RAW" (raw: Switch) => Self::Raw(raw),
    "IMU" (imu: Switch) => Self::Imu(imu),
    "STRENGTH" (strength: Switch) => Self::Strength(strength),
    "BIND,begin" => Self::Bind(BindCommand::Begin),
    "BIND,set" (address: AnyCase) => Self::Bind(BindCommand::Set(address)),
    "BIND,forget" => Self::Bind(BindCommand::Forget),
    "BIND,state" => Self::Bind(BindCommand::State),
    "GATE,set" (gate: Gate) => Self::Gate(GateCommand::Set(gate)),
    "GATE,state" => Self::Gate(GateCommand::State),
    "LOCK,set" (times: LockTimes) => Self::Lock(LockCommand::Set(times)),
    "LOCK,off" => Self::Lock(LockCommand::Off),
    "LOCK,lock" => Self::Lock(LockCommand::Hold { is_locked: true }),
    "LOCK,unlock" => Self::Lock(LockCommand::Hold { is_locked: false }),
    "LOCK,state" => Self::Lock(LockCommand::State),
    "HID,state" => Self::Hid(HidCommand::State),
    "HID,set" (label: Gesture, output: Option<Output>) => Self::Hid(HidCommand::Set(label, output)),
    "HID" (on: Switch) => Self::Hid(HidCommand::Switch(on)),
    "CALIBRATE,begin" => Self::Calibrate(CalibrateCommand::Begin { others: false }),
    "CALIBRATE,begin,other" => Self::Calibrate(CalibrateCommand::Begin { others: true }),
    "CALIBRATE,cancel" => Self::Calibrate(CalibrateCommand::Cancel),
    "CALIBRATE,forget" => Self::Calibrate(CalibrateCommand::Forget),
    "CALIBRATE,state" => Self::Calibrate(CalibrateCommand::State),
    "INSTALL" (transfer: Transfer) => Self::Install(transfer),
    "BLOCK" (number: u32, block: Block) => Self::Block(number, block),
});

/// Codec of `on` and `off`.
pub(super) struct Switch;
field!(Switch => bool: |text, on| text.write_str(if *on { "on" } else { "off" }), |text| match text {
    "on" => Some(true),
    "off" => Some(false),
    _ => None,
});

/// Codec of an address that a person may have written in small letters.
struct AnyCase;
field!(AnyCase => Address: |text, address| write!(text, "{address}"), |text| Address::parse(text).ok());

/// Whether a line with this body is one that the device writes.
///
/// Alignment and movement are reported under the name of their command: with a number behind it, which no command has.
fn is_own(body: &str) -> bool {
    let (name, arguments) = body.split_once(',').unwrap_or((body, ""));
    match name {
        "OK" | "ERR" | "LABEL" | "STATE" | "EMG" => true,
        "ALIGN" | "IMU" => arguments.starts_with(|first: char| first.is_ascii_digit()),
        _ => false,
    }
}

/// Finds commands among received bytes.
///
/// Takes any bytes; each costs bounded work, and nothing is kept of a line that is too long.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CommandReader {
    line: [u8; MAX_COMMAND_BYTES],
    /// Bytes of `line` so far; 0 outside a line.
    length: usize,
}

impl Default for CommandReader {
    fn default() -> Self {
        Self::new()
    }
}

impl CommandReader {
    /// A reader before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            line: [0; MAX_COMMAND_BYTES],
            length: 0,
        }
    }

    /// Takes a byte; if it ends a line, gives the command or why the line is refused.
    pub fn push(&mut self, byte: u8) -> Option<Result<Command, Refusal>> {
        match byte {
            b'$' => self.length = 0,
            _ if self.length == 0 => return None,
            b'\r' | b'\n' => {
                let line = &self.line[..self.length];
                self.length = 0;
                return Command::parse(line).transpose();
            }
            _ => {}
        }
        let Some(free) = self.line.get_mut(self.length) else {
            self.length = 0;
            // Most of the device's own lines are longer than any command.
            let body = core::str::from_utf8(&self.line[1..]);
            let is_own = body.is_ok_and(is_own);
            return (!is_own).then_some(Err(Refusal::TooLong));
        };
        *free = byte;
        self.length += 1;
        None
    }

    /// Bytes were lost: what has come of a line is dropped, and its rest is ignored.
    pub const fn interrupt(&mut self) {
        self.length = 0;
    }
}

#[cfg(test)]
mod tests;
