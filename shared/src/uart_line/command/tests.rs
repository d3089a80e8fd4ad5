//! Commands that are read from lines, damaged ones among them.

use super::*;
use crate::intent::Intent;
use crate::myo::AddressKind;
use crate::stream::lock::LockTimes;
use crate::stream::smoother::{Gate, Reaction};
use crate::uart_line::tests::line as framed;
use alloc::{format, string::ToString, vec, vec::Vec};
use proptest::prelude::*;

fn read(bytes: &[u8]) -> Vec<Result<Command, Refusal>> {
    let mut reader = CommandReader::new();
    bytes.iter().filter_map(|&byte| reader.push(byte)).collect()
}

#[test]
fn lines_are_those_of_the_documentation() {
    let set = AlignCommand::Set(Alignment::new(3, false));
    assert_eq!(read(b"$IDENTIFY*04\r\n"), [Ok(Command::Identify)]);
    let begin = Command::Bind(BindCommand::Begin);
    assert_eq!(begin.to_string(), BEGIN_PAIRING);
    assert_eq!(read(b"$ALIGN,set,3,0*00\r\n"), [Ok(Command::Align(set))]);
}

#[test]
fn a_line_ends_with_cr_or_lf_or_both_and_is_answered_once() {
    for end in ["\r", "\n", "\r\n"] {
        let line = format!("$IDENTIFY*04{end}$COUNTERS*07{end}");
        let found = read(line.as_bytes());
        assert_eq!(found, [Ok(Command::Identify), Ok(Command::Counters)]);
    }
}

#[test]
fn what_is_wrong_is_named() {
    for (line, refusal) in [
        ("$IDENTIFY*05\r\n", Refusal::Checksum(0x04)),
        ("$IDENTIFY\r\n", Refusal::Frame),
        ("$IDENTIFY*4\r\n", Refusal::Frame),
        ("$\r\n", Refusal::Frame),
        ("$IDENT\u{e9}*00\r\n", Refusal::Frame),
    ] {
        assert_eq!(read(line.as_bytes()), [Err(refusal)], "{line}");
    }
    for (body, refusal) in [
        ("", Refusal::Unknown),
        ("identify", Refusal::Unknown),
        ("REBOOT", Refusal::Unknown),
        ("IDENTIFY,1", Refusal::Arguments),
        ("ALIGN", Refusal::Arguments),
        ("ALIGN,", Refusal::Arguments),
        ("ALIGN,set", Refusal::Arguments),
        ("ALIGN,set,8,0", Refusal::Arguments),
        ("ALIGN,set,03,0", Refusal::Arguments),
        ("ALIGN,set,3,2", Refusal::Arguments),
        ("ALIGN,set,3,0,0", Refusal::Arguments),
        ("CALIBRATE", Refusal::Arguments),
        ("CALIBRATE,begin,others", Refusal::Arguments),
        ("LOCK", Refusal::Arguments),
        ("LOCK,set,99,2000", Refusal::Arguments),
        ("LOCK,set,500,120001", Refusal::Arguments),
        ("LOCK,on", Refusal::Arguments),
        ("HID", Refusal::Arguments),
        ("HID,1", Refusal::Arguments),
        ("HID,set,relax,key:a", Refusal::Arguments),
        ("HID,set,close", Refusal::Arguments),
        ("HID,set,close,key:A", Refusal::Arguments),
        ("HID,set,close,key:a,key:b", Refusal::Arguments),
        ("RAW", Refusal::Arguments),
        ("RAW,1", Refusal::Arguments),
        ("BIND", Refusal::Arguments),
        ("BIND,set", Refusal::Arguments),
        ("BIND,set,FA:12:34:56:78", Refusal::Arguments),
        ("BIND,set,FA:12:34:56:78:9A,1", Refusal::Arguments),
        ("BIND,forget,1", Refusal::Arguments),
        ("INSTALL", Refusal::Arguments),
        ("INSTALL,1", Refusal::Arguments),
        ("BLOCK,0,00000000,", Refusal::Arguments),
        ("GATE,states", Refusal::Arguments),
        ("GATE,set,1,2", Refusal::Arguments),
        ("GATE,set,-1,0,-", Refusal::Arguments),
        ("GATE,set,1,2,slow", Refusal::Arguments),
    ] {
        assert_eq!(read(framed(body).as_bytes()), [Err(refusal)], "{body}");
    }
}

#[test]
fn a_line_of_112_bytes_is_read_and_a_longer_one_refused_once() {
    let line = |length| {
        let mut line = alloc::vec![b'x'; length];
        line[0] = b'$';
        line.extend(b"\r\n$IDENTIFY*04\r\n");
        line
    };
    let found = [Err(Refusal::Frame), Ok(Command::Identify)];
    assert_eq!(read(&line(112)), found);
    let found = [Err(Refusal::TooLong), Ok(Command::Identify)];
    assert_eq!(read(&line(113)), found);
    assert_eq!(read(&line(10_000)), found);
}

#[test]
fn the_devices_own_lines_are_not_answered() {
    for line in [
        "$LABEL,2,609,660,close,1,-,0,0,0*0D\r\n",
        "$STATE,0,0,0,relax,0,boot,0,0,0*3F\r\n",
        &framed("OK,ALIGN,begin"),
        &framed("ERR,unknown"),
        &framed("EMG,0,0011223344556677,8899AABBCCDDEEFF"),
        &framed("IMU,0,0000111122223333444455556666777788889999"),
        // As a command begins, and longer than any command.
        "$ALIGN,97,2550,aligned,2,5,0,214,1130*2E\r\n",
        &framed("ALIGN,4294967295,4294967295,poor-distance,255,7,1,4294967295,4294967295"),
        &framed("LABEL,4294967295,4294967295,4294967295,wave-out,1,-,4294967295,4294967295,0"),
        &framed("OK,COUNTERS,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,4294967295,4294967295"),
    ] {
        assert_eq!(read(line.as_bytes()), [], "{line}");
    }
}

#[test]
fn after_lost_bytes_the_rest_of_the_line_is_ignored() {
    let mut reader = CommandReader::new();
    for byte in *b"$IDEN" {
        assert_eq!(reader.push(byte), None);
    }
    reader.interrupt();
    for byte in *b"TIFY*04\r\n" {
        assert_eq!(reader.push(byte), None);
    }
}

fn command() -> impl Strategy<Value = Command> {
    let set = (0_u8..8, any::<bool>()).prop_map(|(turn, mirrored)| {
        Command::Align(AlignCommand::Set(Alignment::new(turn, mirrored)))
    });
    let bind = any::<[u8; 6]>().prop_map(|bytes| {
        let kind = AddressKind::Public;
        Command::Bind(BindCommand::Set(Address { kind, bytes }))
    });
    let margin = || prop::option::of(0_i16..=5000);
    let reaction = prop::option::of(prop::sample::select(&Reaction::ALL[..]));
    let gate = (margin(), margin(), reaction).prop_map(|(entry, other, reaction)| {
        let other = other.map(|other| -other);
        Command::Gate(GateCommand::Set(Gate {
            entry,
            other,
            reaction,
        }))
    });
    let install = any::<[u32; 2]>()
        .prop_map(|[length, checksum]| Command::Install(Transfer { length, checksum }));
    let block = (0_u32..10_000, any::<[[u8; 32]; 2]>()).prop_map(|(number, halves)| {
        let mut block = Block::ERASED;
        block.0.copy_from_slice(halves.as_flattened());
        Command::Block(number, block)
    });
    let lock = (100_u32..=2000, 200_u32..=120_000)
        .prop_map(|(sign, rest)| Command::Lock(LockCommand::Set(LockTimes { sign, rest })));
    let hold = any::<bool>().prop_map(|is_locked| Command::Lock(LockCommand::Hold { is_locked }));
    let outputs = [
        "",
        "key:space",
        "click:left",
        "move:up",
        "button:16",
        "axis:rz-",
    ];
    let hid = (
        prop::sample::select(&Intent::ALL[1..]),
        prop::sample::select(outputs.to_vec()),
    )
        .prop_map(|(label, name)| Command::Hid(HidCommand::Set(label, Output::from_name(name))));
    prop_oneof![
        install,
        hid,
        any::<bool>().prop_map(|on| Command::Hid(HidCommand::Switch(on))),
        Just(Command::Hid(HidCommand::State)),
        lock,
        hold,
        Just(Command::Lock(LockCommand::Off)),
        Just(Command::Lock(LockCommand::State)),
        block,
        any::<bool>().prop_map(Command::Raw),
        any::<bool>().prop_map(Command::Imu),
        any::<bool>().prop_map(Command::Strength),
        gate,
        Just(Command::Gate(GateCommand::State)),
        Just(Command::Bind(BindCommand::Begin)),
        Just(Command::Bind(BindCommand::Forget)),
        Just(Command::Bind(BindCommand::State)),
        bind,
        Just(Command::Identify),
        Just(Command::Battery),
        Just(Command::Counters),
        Just(Command::Align(AlignCommand::Begin(Arm::Unknown))),
        any::<bool>()
            .prop_map(|mirrored| { Command::Align(AlignCommand::Begin(Arm::Known { mirrored })) }),
        Just(Command::Align(AlignCommand::Cancel)),
        Just(Command::Align(AlignCommand::State)),
        set,
    ]
}

proptest! {
    #[test]
    fn every_command_is_read_back_after_any_bytes(noise: Vec<u8>, command in command()) {
        let mut bytes = noise;
        bytes.extend(command.to_string().bytes());
        prop_assert_eq!(read(&bytes).pop(), Some(Ok(command)));
    }

    #[test]
    fn a_command_that_is_cut_is_none_and_the_next_one_is_read(
        command in command(), kept: prop::sample::Index, plug: bool,
    ) {
        let line = command.to_string();
        // The first byte of the line's end ends it.
        let mut bytes = line.as_bytes()[..kept.index(line.len() - 1)].to_vec();
        // A pulled plug looks like these bytes.
        bytes.extend(plug.then_some([0x00, 0xff]).iter().flatten());
        bytes.extend(b"$IDENTIFY*04\r\n");
        prop_assert_eq!(read(&bytes), [Ok(Command::Identify)]);
    }

    #[test]
    fn a_command_with_a_changed_bit_is_never_another(
        command in command(), place: prop::sample::Index, bit in 0_u8..8,
    ) {
        let mut bytes = command.to_string().into_bytes();
        let place = place.index(bytes.len());
        bytes[place] ^= 1 << bit;
        for found in read(&bytes) {
            prop_assert!(found.is_err() || found == Ok(command));
        }
    }
}
