//! Reading an answer: what a program on the PC does with the lines of a board.

use super::{Answer, Binding, Counts, Identity, Refusal};
use crate::myo::{Address, Counters, FirmwareVersion, Following};
use crate::stream::alignment::{Alignment, Arm};
use crate::uart_line::alignment::placement;
use crate::uart_line::command::AlignCommand;
use crate::uart_line::gate::gate;
use crate::uart_line::install::progress;
use crate::uart_line::{ParseError, fields, flag, framed, hexadecimal, number};

const fn wrong(field: &'static str) -> ParseError {
    ParseError::Field { field }
}

impl<'a> Answer<'a> {
    /// Reads one line, CR LF included.
    ///
    /// What the line does not have is not known: an alignment that was set is read as [`Alignment::NONE`], the armband's
    /// hardware revision as 0, its address as public. Written again, the answer is the same line.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &'a [u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }

    /// Reads the body of a line.
    pub(in crate::uart_line) fn of_body(body: &'a str) -> Result<Self, ParseError> {
        let (kind, rest) = body.split_once(',').unwrap_or((body, ""));
        if kind == "ERR" {
            return refusal(rest).map(Self::Refused);
        }
        if kind != "OK" {
            return Err(wrong("kind"));
        }
        let (command, _) = rest.split_once(',').unwrap_or((rest, ""));
        match command {
            "IDENTIFY" => identity(body).map(Self::Identity),
            "COUNTERS" => counts(body).map(Self::Counts),
            "ALIGN" => {
                if let Some(state) = body.strip_prefix("OK,ALIGN,state,") {
                    let alignment = placement(state).ok_or(wrong("align"))?;
                    return Ok(Self::Alignment(alignment));
                }
                let [_, _, name] = fields(body)?;
                let known = [
                    AlignCommand::Begin(Arm::Unknown),
                    AlignCommand::Cancel,
                    AlignCommand::Set(Alignment::NONE),
                ];
                let named = known.into_iter().find(|known| known.name() == name);
                named.map(Self::Align).ok_or(wrong("align"))
            }
            "RAW" => {
                let [_, _, state] = fields(body)?;
                match state {
                    "on" => Ok(Self::Raw(true)),
                    "off" => Ok(Self::Raw(false)),
                    _ => Err(wrong("raw")),
                }
            }
            "BIND" => binding(body).map(Self::Binding),
            "GATE" => {
                let (_, margins) = rest.split_once(',').ok_or(wrong("gate"))?;
                gate(margins).map(Self::Gate).ok_or(wrong("gate"))
            }
            "INSTALL" => {
                let [_, _, missing] = fields(body)?;
                progress(missing).map(Self::Install).ok_or(wrong("block"))
            }
            _ => Err(wrong("command")),
        }
    }
}

fn identity(body: &str) -> Result<Identity<'_>, ParseError> {
    let [
        _,
        _,
        version,
        revision,
        image,
        model,
        armband,
        firmware,
        battery,
    ] = fields(body)?;
    Ok(Identity {
        version: word(version, "version")?,
        revision: word(revision, "revision")?,
        image: word(image, "image")?,
        model: match model {
            "refused" => None,
            _ => Some(checksum(model).ok_or(wrong("model"))?),
        },
        armband: known(armband, |text| address(text, "armband"))?,
        firmware: known(firmware, firmware_version)?,
        battery: known(battery, |text| {
            let percent = number(text, "battery")?;
            u8::try_from(percent).map_err(|_| wrong("battery"))
        })?,
    })
}

/// What `-` stands for, or else what the text says.
fn known<'a, T>(
    text: &'a str,
    read: impl FnOnce(&'a str) -> Result<T, ParseError>,
) -> Result<Option<T>, ParseError> {
    if text == "-" {
        Ok(None)
    } else {
        read(text).map(Some)
    }
}

/// A name that the board gives itself.
fn word<'a>(text: &'a str, field: &'static str) -> Result<&'a str, ParseError> {
    let is_letter = |byte: u8| byte.is_ascii_graphic() && !matches!(byte, b'$' | b'*');
    if text.is_empty() || !text.bytes().all(is_letter) {
        return Err(wrong(field));
    }
    Ok(text)
}

/// Eight lower-case hexadecimal digits.
fn checksum(text: &str) -> Option<u32> {
    let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    if text.len() != 8 || !text.bytes().all(is_digit) {
        return None;
    }
    u32::from_str_radix(text, 16).ok()
}

/// An address in capitals, as it is written.
fn address(text: &str, field: &'static str) -> Result<Address, ParseError> {
    if text.bytes().any(|byte| byte.is_ascii_lowercase()) {
        return Err(wrong(field));
    }
    Address::parse(text).map_err(|_| wrong(field))
}

fn firmware_version(text: &str) -> Result<FirmwareVersion, ParseError> {
    let mut parts = text.split('.');
    let mut part = || {
        let part = number(parts.next().unwrap_or_default(), "firmware")?;
        u16::try_from(part).map_err(|_| wrong("firmware"))
    };
    let version = FirmwareVersion {
        major: part()?,
        minor: part()?,
        patch: part()?,
        hardware: 0,
    };
    match parts.next() {
        None => Ok(version),
        Some(_) => Err(wrong("firmware")),
    }
}

fn counts(body: &str) -> Result<Counts, ParseError> {
    let [_, _, numbers @ ..]: [&str; 18] = fields(body)?;
    let mut counts = [0; 16];
    for (count, text) in counts.iter_mut().zip(numbers) {
        *count = number(text, "count")?;
    }
    let [
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
        packets_dropped,
        lines_dropped,
        emg_dropped,
    ] = counts;
    Ok(Counts {
        session: Counters {
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
        },
        packets_dropped,
        lines_dropped,
        emg_dropped,
    })
}

fn binding(body: &str) -> Result<Binding, ParseError> {
    let [_, _, name, armband, kept] = fields(body)?;
    let armband = known(armband, |text| address(text, "address"))?;
    let following = match (name, armband) {
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
    let is_kept = flag(kept).ok_or(wrong("kept"))?;
    Ok(Binding { following, is_kept })
}

/// The body behind `ERR,`.
fn refusal(why: &str) -> Result<Refusal, ParseError> {
    if let Some(expected) = why.strip_prefix("checksum,") {
        let expected = hexadecimal(expected).ok_or(wrong("expected"))?;
        return Ok(Refusal::Checksum(expected));
    }
    let known = Refusal::ALL.into_iter().filter(|known| known.name() == why);
    // Without the checksum that was expected the word says nothing.
    let mut known = known.filter(|known| !matches!(known, Refusal::Checksum(_)));
    known.next().ok_or(wrong("why"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::myo::AddressKind;
    use crate::stream::smoother::Gate;
    use alloc::{
        format,
        string::{String, ToString},
        vec,
        vec::Vec,
    };
    use proptest::prelude::*;

    fn line(body: &str) -> String {
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${body}*{sum:02X}\r\n")
    }

    fn refused(body: &str) -> ParseError {
        Answer::parse(line(body).as_bytes()).unwrap_err()
    }

    const IDENTITY: &str =
        "OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80";

    #[test]
    fn an_identity_is_read_field_by_field() {
        let text = line(IDENTITY);
        let Ok(Answer::Identity(identity)) = Answer::parse(text.as_bytes()) else {
            panic!("{text}");
        };
        assert_eq!(identity.version, "0.1.0");
        assert_eq!(identity.revision, "0123456789ab");
        assert_eq!(identity.image, "nrf52840-s140");
        assert_eq!(identity.model, Some(0x5f3a_0c11));
        assert_eq!(identity.armband.unwrap().to_string(), "FA:12:34:56:78:9A");
        assert_eq!(identity.firmware.unwrap().patch, 1970);
        assert_eq!(identity.battery, Some(80));
    }

    #[test]
    fn each_wrong_field_of_an_identity_is_named() {
        for (from, to, field) in [
            (",0.1.0,", ",,", "version"),
            ("0123456789ab", "01 23", "revision"),
            ("nrf52840-s140", "$", "image"),
            ("5f3a0c11", "5F3A0C11", "model"),
            ("5f3a0c11", "5f3a0c1", "model"),
            ("5f3a0c11", "-", "model"),
            ("FA:12", "fa:12", "armband"),
            (":9A", "", "armband"),
            ("1.5.1970", "1.5", "firmware"),
            ("1.5.1970", "1.5.1970.2", "firmware"),
            ("1.5.1970", "1.5.65536", "firmware"),
            ("1.5.1970", "1.05.1970", "firmware"),
            (",80", ",256", "battery"),
            (",80", ",", "battery"),
        ] {
            assert_eq!(refused(&IDENTITY.replacen(from, to, 1)), wrong(field));
        }
        let fields = ParseError::Fields {
            expected: 9,
            found: 8,
        };
        assert_eq!(refused(&IDENTITY.replacen(",80", "", 1)), fields);
    }

    #[test]
    fn every_other_refusal_is_named() {
        for (body, field) in [
            ("", "kind"),
            ("LABEL,1", "kind"),
            ("OK", "command"),
            ("OK,REBOOT", "command"),
            ("OK,ALIGN,set,3,0", "fields"),
            ("OK,ALIGN,waiting", "align"),
            ("OK,RAW", "fields"),
            ("OK,RAW,1", "raw"),
            ("OK,BIND,bound,-,1", "address"),
            ("OK,BIND,nobody,FA:12:34:56:78:9A,1", "address"),
            ("OK,BIND,bound,FA:12:34:56:78,1", "address"),
            ("OK,BIND,friend,-,1", "why-this"),
            ("OK,BIND,nobody,-,2", "kept"),
            ("OK,COUNTERS,1", "fields"),
            ("OK,COUNTERS,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,01", "count"),
            ("ERR", "why"),
            ("ERR,tired", "why"),
            ("ERR,checksum", "why"),
            ("ERR,checksum,4", "expected"),
            ("ERR,checksum,0a", "expected"),
            ("ERR,frame,04", "why"),
        ] {
            match refused(body) {
                ParseError::Field { field: found } => assert_eq!(found, field, "{body}"),
                ParseError::Fields { .. } => assert_eq!("fields", field, "{body}"),
                other => panic!("{body}: {other}"),
            }
        }
        let framed = Answer::parse(b"$ERR,frame*00\r\n").unwrap_err();
        assert!(matches!(framed, ParseError::Checksum { found: 0, .. }));
        assert_eq!(Answer::parse(b"$ERR,frame\r\n"), Err(ParseError::Frame));
    }

    fn any_address() -> impl Strategy<Value = Address> {
        any::<[u8; 6]>().prop_map(|bytes| Address {
            kind: AddressKind::Public,
            bytes,
        })
    }

    fn any_answer() -> impl Strategy<Value = Answer<'static>> {
        let firmware = any::<[u16; 3]>().prop_map(|[major, minor, patch]| FirmwareVersion {
            major,
            minor,
            patch,
            hardware: 0,
        });
        let words = prop::sample::select(&["0.1.0", "0123456789ab-dirty", "-", "x"][..]);
        let identity = (
            [words.clone(), words.clone(), words],
            any::<Option<u32>>(),
            prop::option::of(any_address()),
            prop::option::of(firmware),
            any::<Option<u8>>(),
        );
        let identity = identity.prop_map(|(words, model, armband, firmware, battery)| {
            let [version, revision, image] = words;
            Answer::Identity(Identity {
                version,
                revision,
                image,
                model,
                armband,
                firmware,
                battery,
            })
        });
        let counts = any::<[u32; 16]>().prop_map(|numbers| {
            let body = numbers.map(|number| number.to_string()).join(",");
            let line = line(&format!("OK,COUNTERS,{body}"));
            let Ok(Answer::Counts(counts)) = Answer::parse(line.as_bytes()) else {
                panic!("{line}");
            };
            assert_eq!(counts.numbers(), numbers);
            Answer::Counts(counts)
        });
        let following = prop_oneof![
            any_address().prop_map(Following::Pinned),
            any_address().prop_map(Following::Bound),
            Just(Following::Strongest),
            Just(Following::Nobody),
            Just(Following::Pairing),
        ];
        let binding = (following, any::<bool>())
            .prop_map(|(following, is_kept)| Answer::Binding(Binding { following, is_kept }));
        let margin = |least| prop::option::of(least..=5000_i16);
        let gate = (margin(0), margin(-5000))
            .prop_map(|(entry, other)| Answer::Gate(Gate { entry, other }));
        prop_oneof![
            identity,
            counts,
            binding,
            any::<bool>().prop_map(Answer::Raw),
            gate,
            prop::sample::select(&Refusal::ALL[..]).prop_map(Answer::Refused),
            any::<u8>().prop_map(|sum| Answer::Refused(Refusal::Checksum(sum))),
            Just(Answer::Align(AlignCommand::Begin(Arm::Unknown))),
            Just(Answer::Align(AlignCommand::Cancel)),
            Just(Answer::Align(AlignCommand::Set(Alignment::NONE))),
            (0_u8..8, any::<bool>())
                .prop_map(|(turn, mirrored)| Answer::Alignment(Alignment::new(turn, mirrored))),
        ]
    }

    proptest! {
        #[test]
        fn every_answer_is_read_back(answer in any_answer()) {
            let line = answer.to_string();
            prop_assert_eq!(Answer::parse(line.as_bytes()), Ok(answer));
        }

        #[test]
        fn a_cut_answer_is_never_read(answer in any_answer(), kept: prop::sample::Index) {
            let line = answer.to_string();
            let kept = kept.index(line.len());
            prop_assert!(Answer::parse(&line.as_bytes()[..kept]).is_err());
        }

        #[test]
        fn arbitrary_bytes_never_panic(bytes: Vec<u8>) {
            let _ = Answer::parse(&bytes);
        }

        /// Past frame and checksum.
        #[test]
        fn arbitrary_fields_are_refused_or_written_back(
            kind in prop::sample::select(&["OK,IDENTIFY", "OK,BIND", "OK,RAW", "OK,ALIGN", "OK,GATE", "ERR"][..]),
            rest in prop::collection::vec(prop::sample::select(&b"-0123456789abcdefABCDEF:.,"[..]), 0..40),
        ) {
            let rest = core::str::from_utf8(&rest).unwrap();
            let text = line(&format!("{kind},{rest}"));
            if let Ok(answer) = Answer::parse(text.as_bytes()) {
                prop_assert_eq!(answer.to_string(), text);
            }
        }
    }
}
