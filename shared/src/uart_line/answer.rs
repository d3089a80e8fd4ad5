//! The device's answer to a command: one ASCII line each, in the order of the commands.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = "OK,IDENTIFY," version "," revision "," image "," model "," armband "," firmware "," battery
//!          | "OK,COUNTERS," number { "," number }      16 of them: the fields of `Counts`, in order
//!          | "OK,ALIGN," ( "begin" | "cancel" | "set" )
//!          | "OK,ALIGN,state," turn "," mirrored      as in force
//!          | "OK,RAW," ( "on" | "off" )
//!          | "OK,BIND," why-this "," address "," kept
//!          | "OK,GATE," entry "," other          super::gate
//!          | "OK,INSTALL," ( block | "done" )     super::install: missing next; the model is in use
//!          | "ERR," why
//! version  = of the program, such as 0.1.0
//! revision = of its source
//! image    = which board and radio it is built for
//! model    = CRC-32 of the model file, eight hexadecimal digits | "refused"
//! armband  = address of the armband that is connected | "-"
//! firmware = its firmware, such as 1.5.1970 | "-"
//! battery  = its charge in percent | "-"
//! turn     = "0" ... "7"              places that the armband is turned by
//! mirrored = "0" | "1"                whether its electrodes run the other way round
//! why-this = "built-in"               the armband whose address was given when the program was built
//!          | "bound"                  the armband that is bound
//!          | "strongest"              none is bound, and the program was built to follow any
//!          | "nobody"                 none is bound
//!          | "pairing"                30 s are not over
//! address  = of the armband that is followed | "-"
//! kept     = "1" | "0"               whether the bound armband, or that there is none, will outlast a restart
//! why      = "too-long"               more than 112 bytes without an end
//!          | "frame"                  not `$...*HH` in ASCII
//!          | "checksum," expected     the checksum that the line should have had
//!          | "unknown"                no such command
//!          | "arguments"              the command has no such arguments
//!          | "no-model"               the model was refused, so there is nothing to do this with
//!          | "no-stream"              no armband streams
//!          | "built-in"               the armband's address was given when the program was built
//!          | "busy"                   not done within a second: ask again
//!          | "length"                 the file does not fit into the region of the model
//!          | "block"                  a block's own checksum is wrong: send it again
//!          | "not-begun"              no installation is in progress
//!          | "model"                  the file is no model that this program can run
//!          | "flash"                  flash was not erased or written: send it again
//! ```
//!
//! `number` and `checksum` are those of the other lines. An answer has no line number and is not counted among the
//! lines with one: who only listens sees no jump. A line has at most 256 bytes.
//!
//! ```text
//! $OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80*05
//! $ERR,checksum,04*4C
//! ```

mod matching;
mod reading;

use core::fmt;

use super::alignment::Placed;
use super::command::AlignCommand;
use super::gate::Margins;
use super::install::Missing;
pub use super::refusal::Refusal;
use super::write_framed;
use crate::installation::Progress;
use crate::myo::{Address, Counters, FirmwareVersion, Following};
use crate::stream::alignment::Alignment;
use crate::stream::smoother::Gate;

/// What runs here.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Identity<'a> {
    /// Of the program.
    pub version: &'a str,
    /// Of its source.
    pub revision: &'a str,
    /// Board and radio.
    pub image: &'a str,
    /// CRC-32 of the model file; none if it was refused.
    pub model: Option<u32>,
    /// The armband that is connected.
    pub armband: Option<Address>,
    /// Its firmware.
    pub firmware: Option<FirmwareVersion>,
    /// Its charge in percent.
    pub battery: Option<u8>,
}

/// What was lost and dropped since the start. Each count stays at its maximum, but for the dropped ones, which wrap.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counts {
    /// Of the sessions with armbands.
    pub session: Counters,
    /// Packets of two samples that the inference was too slow for.
    pub packets_dropped: u32,
    /// Lines that the UART was too slow for.
    pub lines_dropped: u32,
    /// `$EMG` lines that the UART was too slow for.
    pub emg_dropped: u32,
}

impl Counts {
    /// In the order of the line.
    #[must_use]
    pub const fn numbers(&self) -> [u32; 16] {
        let Counters {
            connections,
            failed_connects,
            timeouts,
            stalls,
            failed_set_ups,
            refused,
            notifications,
            lost,
            given_up,
            duplicates,
            reordered,
            malformed,
            foreign,
        } = self.session;
        [
            connections,
            failed_connects,
            timeouts,
            stalls,
            failed_set_ups,
            refused,
            notifications,
            lost,
            given_up,
            duplicates,
            reordered,
            malformed,
            foreign,
            self.packets_dropped,
            self.lines_dropped,
            self.emg_dropped,
        ]
    }
}

/// Which armband is followed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Binding {
    /// Which one, and why.
    pub following: Following,
    /// Whether the bound armband, or that there is none, will outlast a restart.
    pub is_kept: bool,
}

/// Content of an answer. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer<'a> {
    /// To `IDENTIFY`.
    Identity(Identity<'a>),
    /// To `COUNTERS`.
    Counts(Counts),
    /// To `ALIGN`: accepted. `$ALIGN` lines say what comes of it.
    Align(AlignCommand),
    /// To `ALIGN,state`: in force.
    Alignment(Alignment),
    /// To `RAW`, as it is from now on.
    Raw(bool),
    /// To `BIND`, as it is from now on.
    Binding(Binding),
    /// To `GATE`, as it is from now on.
    Gate(Gate),
    /// To `INSTALL` and `BLOCK`: what is missing.
    Install(Progress),
    /// The command is not carried out.
    Refused(Refusal),
}

impl fmt::Display for Answer<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Identity(identity) => {
                write_framed(formatter, format_args!("OK,IDENTIFY,{identity}"))
            }
            Self::Counts(counts) => {
                write_framed(formatter, format_args!("OK,COUNTERS{}", Listed(counts)))
            }
            Self::Align(command) => {
                write_framed(formatter, format_args!("OK,ALIGN,{}", command.name()))
            }
            Self::Alignment(alignment) => write_framed(
                formatter,
                format_args!("OK,ALIGN,state,{}", Placed(*alignment)),
            ),
            Self::Raw(true) => write_framed(formatter, format_args!("OK,RAW,on")),
            Self::Raw(false) => write_framed(formatter, format_args!("OK,RAW,off")),
            Self::Binding(binding) => write_framed(formatter, format_args!("OK,BIND,{binding}")),
            Self::Gate(gate) => write_framed(formatter, format_args!("OK,GATE,{}", Margins(*gate))),
            Self::Install(progress) => {
                write_framed(formatter, format_args!("OK,INSTALL,{}", Missing(*progress)))
            }
            Self::Refused(Refusal::Checksum(expected)) => {
                write_framed(formatter, format_args!("ERR,checksum,{expected:02X}"))
            }
            Self::Refused(refusal) => {
                write_framed(formatter, format_args!("ERR,{}", refusal.name()))
            }
        }
    }
}

impl fmt::Display for Identity<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            version,
            revision,
            image,
            ..
        } = self;
        write!(formatter, "{version},{revision},{image},")?;
        match self.model {
            Some(checksum) => write!(formatter, "{checksum:08x},")?,
            None => formatter.write_str("refused,")?,
        }
        match self.armband {
            Some(address) => write!(formatter, "{address},")?,
            None => formatter.write_str("-,")?,
        }
        match self.firmware {
            Some(FirmwareVersion {
                major,
                minor,
                patch,
                ..
            }) => write!(formatter, "{major}.{minor}.{patch},")?,
            None => formatter.write_str("-,")?,
        }
        match self.battery {
            Some(percent) => write!(formatter, "{percent}"),
            None => formatter.write_str("-"),
        }
    }
}

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

impl fmt::Display for Binding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        let is_kept = u8::from(self.is_kept);
        match self.following.address() {
            Some(address) => write!(formatter, "{name},{address},{is_kept}"),
            None => write!(formatter, "{name},-,{is_kept}"),
        }
    }
}

/// Numbers, a comma before each.
struct Listed<'c>(&'c Counts);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut numbers = self.0.numbers().into_iter();
        numbers.try_for_each(|number| write!(formatter, ",{number}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::myo::AddressKind;
    use crate::stream::alignment::Arm;
    use alloc::{format, string::ToString};

    const IDENTITY: Identity<'_> = Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "nrf52840-s140",
        model: Some(0x5f3a_0c11),
        armband: Some(Address {
            kind: AddressKind::Public,
            bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
        }),
        firmware: Some(FirmwareVersion {
            major: 1,
            minor: 5,
            patch: 1970,
            hardware: 2,
        }),
        battery: Some(80),
    };

    /// A line with the right checksum.
    fn framed(body: &str) -> alloc::string::String {
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${body}*{sum:02X}\r\n")
    }

    #[test]
    fn lines_are_those_of_the_documentation() {
        let line = "$OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80*05\r\n";
        assert_eq!(Answer::Identity(IDENTITY).to_string(), line);
        let refused = Answer::Refused(Refusal::Checksum(4)).to_string();
        assert_eq!(refused, "$ERR,checksum,04*4C\r\n");
    }

    #[test]
    fn every_answer_has_the_body_of_its_grammar() {
        let unknown = Identity {
            model: None,
            armband: None,
            firmware: None,
            battery: None,
            ..IDENTITY
        };
        let counts = Counts {
            session: Counters {
                connections: 1,
                foreign: 13,
                ..Counters::default()
            },
            packets_dropped: 14,
            lines_dropped: 15,
            emg_dropped: u32::MAX,
        };
        let set = AlignCommand::Set(Alignment::new(3, true));
        for (answer, body) in [
            (
                Answer::Identity(unknown),
                "OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,refused,-,-,-",
            ),
            (
                Answer::Counts(counts),
                "OK,COUNTERS,1,0,0,0,0,0,0,0,0,0,0,0,13,14,15,4294967295",
            ),
            (
                Answer::Align(AlignCommand::Begin(Arm::Unknown)),
                "OK,ALIGN,begin",
            ),
            (Answer::Align(AlignCommand::Cancel), "OK,ALIGN,cancel"),
            (Answer::Align(set), "OK,ALIGN,set"),
            (
                Answer::Alignment(Alignment::new(3, true)),
                "OK,ALIGN,state,3,1",
            ),
            (Answer::Raw(true), "OK,RAW,on"),
            (Answer::Raw(false), "OK,RAW,off"),
            (
                binding(Following::Bound(IDENTITY.armband.unwrap()), true),
                "OK,BIND,bound,FA:12:34:56:78:9A,1",
            ),
            (binding(Following::Nobody, false), "OK,BIND,nobody,-,0"),
            (binding(Following::Pairing, true), "OK,BIND,pairing,-,1"),
            (binding(Following::Strongest, true), "OK,BIND,strongest,-,1"),
            (Answer::Install(Progress::Next(1355)), "OK,INSTALL,1355"),
            (Answer::Install(Progress::Installed), "OK,INSTALL,done"),
            (Answer::Refused(Refusal::TooLong), "ERR,too-long"),
            (Answer::Refused(Refusal::NoModel), "ERR,no-model"),
        ] {
            assert_eq!(answer.to_string(), framed(body));
        }
    }

    fn binding(following: Following, is_kept: bool) -> Answer<'static> {
        Answer::Binding(Binding { following, is_kept })
    }

    #[test]
    fn the_longest_answer_fits_256_bytes() {
        let most = u32::MAX;
        let session = Counters {
            connections: most,
            failed_connects: most,
            timeouts: most,
            stalls: most,
            failed_set_ups: most,
            refused: most,
            notifications: most,
            lost: most,
            given_up: most,
            duplicates: most,
            reordered: most,
            malformed: most,
            foreign: most,
        };
        let counts = Counts {
            session,
            packets_dropped: most,
            lines_dropped: most,
            emg_dropped: most,
        };
        assert!(Answer::Counts(counts).to_string().len() <= 256);
        let identity = Identity {
            version: "100.100.100",
            revision: "0123456789ab-dirty",
            firmware: Some(FirmwareVersion {
                major: u16::MAX,
                minor: u16::MAX,
                patch: u16::MAX,
                hardware: 0,
            }),
            battery: Some(100),
            ..IDENTITY
        };
        assert!(Answer::Identity(identity).to_string().len() <= 256);
    }
}
