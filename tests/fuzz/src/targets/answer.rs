//! Answers to commands, with any counters and armbands: each is a line that is no command and is read back.

use shared::myo::{Address, AddressKind, Counters, FirmwareVersion, Following};
use shared::stream::alignment::Alignment;
use shared::stream::lock::LockTimes;
use shared::stream::smoother::{Gate, Reaction};
use shared::uart_line::answer::{Accepted, Answer, Binding, Counts, Identity, Refusal};
use shared::uart_line::lock::Locking;

use super::report::is_not_answered;
use crate::input::Input;

/// Takes an answer of any content.
pub fn run(data: &[u8]) {
    let input = &mut Input(data);
    let line = answer(input).to_string();
    assert!(line.len() <= 256 && line.is_ascii(), "{line}");
    assert!(line.starts_with('$') && line.ends_with("\r\n"), "{line}");
    assert_eq!(
        line.matches(['\r', '\n', '$', '*']).count(),
        4,
        "one line: {line}"
    );
    let (body, sum) = line[1..line.len() - 2]
        .rsplit_once('*')
        .expect("a checksum");
    let expected = body.bytes().fold(0, |sum, byte| sum ^ byte);
    assert_eq!(sum, format!("{expected:02X}"));
    is_not_answered(&line);
    let read = Answer::parse(line.as_bytes()).expect("the device's own answer");
    assert_eq!(read.to_string(), line);
}

fn answer(input: &mut Input<'_>) -> Answer<'static> {
    match input.below(8) {
        0 => Answer::Identity(Identity {
            version: env!("CARGO_PKG_VERSION"),
            revision: "0123456789ab-modified",
            image: "nrf52840-trouble",
            model: input.flag().then(|| input.word()),
            armband: input.flag().then(|| address(input)),
            firmware: input.flag().then(|| firmware(input)),
            battery: input.flag().then(|| input.byte()),
        }),
        1 => Answer::Counts(Counts {
            session: Counters {
                connections: input.word(),
                failed_connects: input.word(),
                timeouts: input.word(),
                stalls: input.word(),
                failed_set_ups: input.word(),
                refused: input.word(),
                notifications: input.word(),
                lost: input.word(),
                given_up: input.word(),
                duplicates: input.word(),
                reordered: input.word(),
                malformed: input.word(),
                foreign: input.word(),
            },
            packets_dropped: input.word(),
            lines_dropped: input.word(),
            emg_dropped: input.word(),
        }),
        2 => match input.below(4) {
            0 => Answer::Align(Accepted::Begin),
            1 => Answer::Align(Accepted::Cancel),
            2 => Answer::Align(Accepted::Set),
            _ => Answer::Alignment(Alignment::new(input.byte(), input.flag())),
        },
        3 => Answer::Raw(input.flag()),
        4 => Answer::Binding(Binding {
            following: match input.below(5) {
                0 => Following::Pinned(address(input)),
                1 => Following::Bound(address(input)),
                2 => Following::Strongest,
                3 => Following::Nobody,
                _ => Following::Pairing,
            },
            is_kept: input.flag(),
        }),
        5 => Answer::Gate(Gate {
            entry: input.flag().then(|| i16::from(input.byte()) * 19),
            other: input.flag().then(|| i16::from(input.byte()) * 39 - 4972),
            reaction: Reaction::ALL.get(input.below(4)).copied(),
        }),
        6 => Answer::Lock(input.flag().then(|| Locking {
            times: LockTimes {
                sign: 100 + 7 * u32::from(input.byte()),
                rest: 200 + 469 * u32::from(input.byte()),
            },
            locked: input.flag(),
        })),
        _ => Answer::Refused(match input.below(9) {
            0 => Refusal::TooLong,
            1 => Refusal::Frame,
            2 => Refusal::Checksum(input.byte()),
            3 => Refusal::Unknown,
            4 => Refusal::Arguments,
            5 => Refusal::NoModel,
            6 => Refusal::NoStream,
            7 => Refusal::BuiltIn,
            _ => Refusal::Busy,
        }),
    }
}

fn address(input: &mut Input<'_>) -> Address {
    let kind = if input.flag() {
        AddressKind::Random
    } else {
        AddressKind::Public
    };
    let bytes = input.array();
    Address { kind, bytes }
}

fn firmware(input: &mut Input<'_>) -> FirmwareVersion {
    let [major, minor, patch, hardware] = [(); 4].map(|()| u16::from_le_bytes(input.array()));
    FirmwareVersion {
        major,
        minor,
        patch,
        hardware,
    }
}
