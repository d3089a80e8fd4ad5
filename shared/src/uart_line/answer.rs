//! The device's answer to a command: one ASCII line each, in the order of the commands.
//!
//! [`Answer`]'s rows are the grammar; docs/uart.md says what the fields mean. An answer has no line number and is not counted
//! among the lines with one: a program that only listens sees no jump. A line has at most 256 bytes.
//!
//! ```text
//! $OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80*05
//! $ERR,checksum,04*4C
//! ```

mod counts;
mod matching;

use core::fmt::{self, Write as _};

use super::ParseError;
use super::calibration::CalibrationReport;
use super::command::{AlignCommand, Switch};
use super::fields::{Fields, Reader, Rows, Writer, field, fields, rows, wrong};
use super::frame::{framed, hexadecimal, number};
use super::lock::Locking;
pub use super::refusal::Refusal;
use crate::hid::Settings;
use crate::installation::InstallationProgress;
use crate::myo::{Address, FirmwareVersion, Following};
use crate::names::names;
use crate::stream::alignment::Alignment;
use crate::stream::smoother::Gate;
pub use counts::Counts;

/// Identity of the program, its model and the connected armband.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Identity<'a> {
    /// Version of the program.
    pub version: &'a str,
    /// Revision of the program's source.
    pub revision: &'a str,
    /// Board and radio.
    pub image: &'a str,
    /// CRC-32 of the model file; none if it was refused.
    pub model: Option<u32>,
    /// The armband that is connected.
    pub armband: Option<Address>,
    /// Firmware of the armband.
    pub firmware: Option<FirmwareVersion>,
    /// Battery charge of the armband, percent.
    pub battery: Option<u8>,
}

/// Charge of the board's own battery.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Charge {
    /// Voltage, millivolts.
    pub millivolts: u32,
    /// Charge in percent, 0 to 100, estimated from the voltage.
    pub percent: u8,
}

/// Armband that is followed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Binding {
    /// The armband, and why it is followed.
    pub following: Following,
    /// Whether the binding, or its absence, will outlast a restart.
    pub is_kept: bool,
}

names! {
    /// Command about the alignment that is accepted.
    pub enum Accepted {
        /// An alignment has begun.
        Begin = "begin",
        /// No alignment is in progress any more.
        Cancel = "cancel",
        /// The alignment is set.
        Set = "set",
    }
}

impl Accepted {
    /// Answer to an accepted command; none where the answer is the alignment in force.
    #[must_use]
    pub const fn of(command: AlignCommand) -> Option<Self> {
        match command {
            AlignCommand::Begin(_) => Some(Self::Begin),
            AlignCommand::Cancel => Some(Self::Cancel),
            AlignCommand::Set(_) => Some(Self::Set),
            AlignCommand::State => None,
        }
    }
}

/// Content of an answer. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer<'a> {
    /// Answer to `IDENTIFY`.
    Identity(Identity<'a>),
    /// Answer to `IDENTIFY,battery`; none on a board that does not measure its battery.
    Battery(Option<Charge>),
    /// Answer to `COUNTERS`.
    Counts(Counts),
    /// Answer to `ALIGN`: accepted. `$ALIGN` lines report the result.
    Align(Accepted),
    /// Answer to `ALIGN,state`: the alignment in force.
    Alignment(Alignment),
    /// Answer to `RAW`: whether the raw stream is on from now on.
    Raw(bool),
    /// Answer to `IMU`: whether movement is written from now on.
    Imu(bool),
    /// Answer to `STRENGTH`: whether lines have the strength from now on.
    Strength(bool),
    /// Answer to `BIND`: the binding from now on.
    Binding(Binding),
    /// Answer to `GATE`: the gate from now on.
    Gate(Gate),
    /// Answer to `LOCK`: the lock from now on; none if labels are not locked.
    Lock(Option<Locking>),
    /// Answer to `HID`: the outputs from now on.
    Hid(Settings),
    /// Answer to `CALIBRATE`: how far it is, and whether a calibration is in use.
    Calibration(CalibrationReport, bool),
    /// Answer to `INSTALL` and `BLOCK`: the next missing block.
    Install(InstallationProgress),
    /// The command is not carried out.
    Refused(Refusal),
}

impl<'a> Answer<'a> {
    /// Reads one line, CR LF included.
    ///
    /// Values that are not on the line are replaced: the armband's hardware revision by 0, the kind of its
    /// address by public. Written again, the answer is the same line.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &'a [u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }
}

rows!(Answer<'a> {
    "OK,IDENTIFY,battery" (battery: Option<Charge>) => Self::Battery(battery),
    "OK,IDENTIFY" (identity: Identity<'_>) => Self::Identity(identity),
    "OK,COUNTERS" (counts: Counts) => Self::Counts(counts),
    "OK,ALIGN,state" (alignment: Alignment) => Self::Alignment(alignment),
    "OK,ALIGN" (align: Accepted) => Self::Align(align),
    "OK,RAW" (raw: Switch) => Self::Raw(raw),
    "OK,IMU" (imu: Switch) => Self::Imu(imu),
    "OK,STRENGTH" (strength: Switch) => Self::Strength(strength),
    "OK,BIND" (binding: Binding) => Self::Binding(binding),
    "OK,GATE" (gate: Gate) => Self::Gate(gate),
    "OK,LOCK,off" => Self::Lock(None),
    "OK,LOCK" (lock: Locking) => Self::Lock(Some(lock)),
    "OK,HID" (outputs: Settings) => Self::Hid(outputs),
    "OK,CALIBRATE" (report: CalibrationReport, in_use: bool) => Self::Calibration(report, in_use),
    "OK,INSTALL,done" => Self::Install(InstallationProgress::Installed),
    "OK,INSTALL" (block: u32) => Self::Install(InstallationProgress::Next(block)),
    "ERR,too-long" => Self::Refused(Refusal::TooLong),
    "ERR,frame" => Self::Refused(Refusal::Frame),
    "ERR,checksum" (expected: Checksum) => Self::Refused(Refusal::Checksum(expected)),
    "ERR,unknown" => Self::Refused(Refusal::Unknown),
    "ERR,arguments" => Self::Refused(Refusal::Arguments),
    "ERR,no-model" => Self::Refused(Refusal::NoModel),
    "ERR,no-stream" => Self::Refused(Refusal::NoStream),
    "ERR,built-in" => Self::Refused(Refusal::BuiltIn),
    "ERR,busy" => Self::Refused(Refusal::Busy),
    "ERR,no-room" => Self::Refused(Refusal::NoRoom),
    "ERR,length" => Self::Refused(Refusal::Length),
    "ERR,block" => Self::Refused(Refusal::Block),
    "ERR,not-begun" => Self::Refused(Refusal::NotBegun),
    "ERR,model" => Self::Refused(Refusal::Model),
    "ERR,flash" => Self::Refused(Refusal::Flash),
});

fields!(<'a> Identity<'a> {
    version: str,
    revision: str,
    image: str,
    model: ModelChecksum,
    armband: Option<Address>,
    firmware: Option<FirmwareVersion>,
    battery: Option<u8>,
});

fields!(Charge {
    millivolts: u32,
    percent: u8
});

/// Codec of the CRC-32 of the model file; none if it was refused.
struct ModelChecksum;
field!(ModelChecksum => Option<u32>: |text, checksum| match checksum {
    Some(checksum) => write!(text, "{checksum:08x}"),
    None => text.write_str("refused"),
}, |text| match text {
    "refused" => Some(None),
    _ => hexadecimal(text.as_bytes(), 8, b'a').map(Some),
});

/// Codec of the checksum that a line should have had.
struct Checksum;
field!(Checksum => u8: |text, sum| write!(text, "{sum:02X}"), |text| {
    hexadecimal(text.as_bytes(), 2, b'A').map(|sum| sum as u8)
});

field!(FirmwareVersion => Self: |text, version| {
    write!(text, "{}.{}.{}", version.major, version.minor, version.patch)
}, firmware_version);

fn firmware_version(text: &str) -> Option<FirmwareVersion> {
    let mut parts = text.split('.');
    let mut part = || number(parts.next()?)?.try_into().ok();
    let [major, minor, patch] = [part()?, part()?, part()?];
    let version = FirmwareVersion {
        major,
        minor,
        patch,
        hardware: 0,
    };
    parts.next().is_none().then_some(version)
}

// An address in capitals, as it is written.
field!(Address => Self: |text, address| write!(text, "{address}"), |text| {
    let address = Self::parse(text).ok()?;
    (!text.bytes().any(|byte| byte.is_ascii_lowercase())).then_some(address)
});

field!(Accepted => Self: |text, accepted| text.write_str(accepted.name()), Accepted::from_name);

impl Binding {
    /// Why this armband is followed, as the line has it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self.following {
            Following::Pinned(_) => "built-in",
            Following::Bound(_) => "bound",
            Following::Strongest => "strongest",
            Following::Nobody => "nobody",
            Following::Pairing => "pairing",
        }
    }
}

impl Fields<'_> for Binding {
    type Value = Self;
    const COUNT: usize = 3;

    fn write(binding: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        line.text(binding.name())?;
        Option::<Address>::write(&binding.following.address(), line)?;
        bool::write(&binding.is_kept, line)
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        let why = <str as Fields<'_>>::read(line, "why-this")?;
        let address = Option::<Address>::read(line, "address")?;
        let following = match (why, address) {
            ("built-in", Some(armband)) => Following::Pinned(armband),
            ("bound", Some(armband)) => Following::Bound(armband),
            ("strongest", None) => Following::Strongest,
            ("nobody", None) => Following::Nobody,
            ("pairing", None) => Following::Pairing,
            ("built-in" | "bound" | "strongest" | "nobody" | "pairing", _) => {
                return Err(wrong("address"));
            }
            _ => return Err(wrong("why-this")),
        };
        let is_kept = bool::read(line, "kept")?;
        Ok(Self { following, is_kept })
    }
}
