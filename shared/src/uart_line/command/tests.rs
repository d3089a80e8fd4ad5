//! Commands that are read from lines, damaged ones among them.

use super::*;
use crate::intent::Intent;
use crate::myo::AddressKind;
use crate::stream::smoother::Reaction;
use crate::uart_line::tests::line as framed;
use alloc::{format, string::ToString, vec, vec::Vec};

/// Bodies of commands: every row of the table, its arguments at the ends of what they may be.
const BODIES: &str = "
    IDENTIFY IDENTIFY,battery COUNTERS
    ALIGN,begin ALIGN,begin,0 ALIGN,begin,1 ALIGN,cancel ALIGN,set,0,0 ALIGN,set,7,1 ALIGN,state
    RAW,on RAW,off IMU,on IMU,off STRENGTH,on STRENGTH,off
    BIND,begin BIND,set,00:00:00:00:00:FF BIND,forget BIND,state
    GATE,set,-,-,- GATE,set,0,-5000,fast GATE,set,5000,0,late GATE,set,7,5000,balanced GATE,state
    LOCK,set,100,200 LOCK,set,2000,120000 LOCK,off LOCK,lock LOCK,unlock LOCK,state
    HID,on HID,off HID,set,open,- HID,set,wave-out,key:space HID,set,pinch,axis:rz- HID,state
    CALIBRATE,begin CALIBRATE,begin,other CALIBRATE,cancel CALIBRATE,forget CALIBRATE,state
    INSTALL,0,00000000 INSTALL,4294967295,ffffffff
";

/// Bodies with arguments that their command does not have.
const WRONG_ARGUMENTS: &str = "
    IDENTIFY,1
    ALIGN ALIGN, ALIGN,set ALIGN,set,8,0 ALIGN,set,03,0 ALIGN,set,3,2 ALIGN,set,3,0,0
    CALIBRATE CALIBRATE,begin,others
    LOCK LOCK,set,99,2000 LOCK,set,500,120001 LOCK,on
    HID HID,1 HID,set,relax,key:a HID,set,close HID,set,close,key:A HID,set,close,key:a,key:b
    RAW RAW,1
    BIND BIND,set BIND,set,FA:12:34:56:78 BIND,set,FA:12:34:56:78:9A,1 BIND,forget,1
    INSTALL INSTALL, INSTALL,1 INSTALL,086729,0f3a0c11 INSTALL,1,0F3A0C11 INSTALL,1,f3a0c11
    INSTALL,1,+f3a0c11
    BLOCK,0,00000000, BLOCK,1,2,3
    GATE,states GATE,set,1,2 GATE,set,1,2,slow GATE,set,-1,0,- GATE,set,,0,- GATE,set,5001,0,-
    GATE,set,0,5001,- GATE,set,0,-5001,- GATE,set,01,0,- GATE,set,0,-0,- GATE,set,+1,0,-
    GATE,set,1.5,0,- GATE,set,99999,0,- GATE,set,0,--1,-
";

/// Bytes of a block, of which Python makes [`CONTENT`]: base64.b64encode(bytes(7 * place % 256 for place in range(64))).
const BLOCK: Block = {
    let mut bytes = [0; 64];
    let mut place = 0;
    while place < bytes.len() {
        bytes[place] = (7 * place) as u8;
        place += 1;
    }
    Block(bytes)
};
const CONTENT: &str =
    "AAcOFRwjKjE4P0ZNVFtiaXB3foWMk5qhqK+2vcTL0tng5+71/AMKERgfJi00O0JJUFdeZWxzeoGIj5adpKuyuQ";

fn read(bytes: &[u8]) -> Vec<Result<Command, Refusal>> {
    let mut reader = CommandReader::default();
    bytes.iter().filter_map(|&byte| reader.push(byte)).collect()
}

#[test]
fn lines_of_the_documentation_are_read() {
    let lines = include_str!("../command.rs").lines();
    let shown: Vec<_> = lines
        .filter_map(|line| line.strip_prefix("//! $"))
        .collect();
    assert!(!shown.is_empty());
    for text in shown {
        let read = read(format!("${text}\r\n").as_bytes());
        assert!(matches!(read[..], [Ok(_)]), "{text}");
    }
}

/// Lines of all commands, a block's among them, with what is read from them.
fn commands() -> Vec<(alloc::string::String, Command)> {
    let lines = BODIES.split_whitespace().map(framed);
    let lines = lines.chain([Command::Block(1355, BLOCK).to_string()]);
    lines
        .map(|line| match read(line.as_bytes())[..] {
            [Ok(command)] => (line, command),
            ref other => panic!("{line}: {other:?}"),
        })
        .collect()
}

#[test]
fn what_is_read_is_written_back_and_is_read_after_any_bytes() {
    for (line, command) in commands() {
        assert_eq!(command.to_string(), line);
        assert!(line.len() <= MAX_COMMAND_BYTES + 2);
        for noise in [&b"$IDEN"[..], b"\xff\x00$$*", b"*05\r\n$", &[b'x'; 300]] {
            let bytes = [noise, line.as_bytes()].concat();
            assert_eq!(read(&bytes).last(), Some(&Ok(command)), "{line}");
        }
    }
}

#[test]
fn arguments_have_their_places() {
    let armband = Address {
        kind: AddressKind::Public,
        bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
    };
    let gate = Gate {
        entry: Some(1),
        other: Some(-2),
        reaction: Some(Reaction::Steady),
    };
    let times = LockTimes {
        sign: 500,
        rest: 2000,
    };
    let transfer = Transfer {
        length: 86_729,
        checksum: 0x0f3a_0c11,
    };
    let set = AlignCommand::Set(Alignment::new(3, true));
    let known = Arm::Known { mirrored: true };
    let output = HidCommand::Set(Intent::Close, Output::from_name("key:space"));
    #[rustfmt::skip]
    let table = [
        (Command::Align(set), "ALIGN,set,3,1"),
        (Command::Align(AlignCommand::Begin(known)), "ALIGN,begin,1"),
        (Command::Bind(BindCommand::Set(armband)), "BIND,set,fa:12:34:56:78:9a"),
        (Command::Gate(GateCommand::Set(gate)), "GATE,set,1,-2,steady"),
        (Command::Lock(LockCommand::Set(times)), "LOCK,set,500,2000"),
        (Command::Hid(output), "HID,set,close,key:space"),
        (Command::Install(transfer), "INSTALL,86729,0f3a0c11"),
    ];
    for (command, body) in table {
        assert_eq!(read(framed(body).as_bytes()), [Ok(command)], "{body}");
    }
    let begin = Command::Bind(BindCommand::Begin);
    assert_eq!(begin.to_string(), BEGIN_PAIRING);
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
        ("$*00\r\n", Refusal::Unknown),
        (&framed("identify"), Refusal::Unknown),
        (&framed("REBOOT"), Refusal::Unknown),
    ] {
        assert_eq!(read(line.as_bytes()), [Err(refusal)], "{line}");
    }
    for body in WRONG_ARGUMENTS.split_whitespace() {
        let found = read(framed(body).as_bytes());
        assert_eq!(found, [Err(Refusal::Arguments)], "{body}");
    }
}

#[test]
fn a_block_has_one_spelling_and_a_checksum_of_its_own() {
    let text = Command::Block(1355, BLOCK).to_string();
    let body = &text[1..text.len() - 5];
    assert_eq!(body.rsplit_once(',').unwrap().1, CONTENT);
    for wrong in [
        &body[..body.len() - 1],
        &format!("{body}A"),
        &format!("{body}=="),
        &body.replace("1355,", "01355,"),
        // Bits behind the last byte.
        &format!("{}R", &body[..body.len() - 1]),
    ] {
        let found = read(framed(wrong).as_bytes());
        assert_eq!(found, [Err(Refusal::Arguments)], "{wrong}");
    }
    let other = Command::Block(1355, Block::ERASED).to_string();
    let mixed = format!("{}{}", &body[..20], &other[21..other.len() - 5]);
    assert_eq!(read(framed(&mixed).as_bytes()), [Err(Refusal::Block)]);
}

#[test]
fn a_line_of_112_bytes_is_read_and_a_longer_one_refused_once() {
    let line = |length| {
        let mut line = vec![b'x'; length];
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
fn after_lost_bytes_the_rest_of_the_line_is_ignored() {
    let mut reader = CommandReader::default();
    for byte in *b"$IDEN" {
        assert_eq!(reader.push(byte), None);
    }
    reader.interrupt();
    for byte in *b"TIFY*04\r\n" {
        assert_eq!(reader.push(byte), None);
    }
}

#[test]
fn a_command_that_is_cut_or_has_a_changed_bit_is_never_another() {
    for (line, command) in commands() {
        // The first byte of the line's end ends it.
        for kept in 0..line.len() - 1 {
            // A pulled plug looks like these bytes.
            for plug in [&b""[..], &[0x00, 0xff]] {
                let bytes = [&line.as_bytes()[..kept], plug, b"$IDENTIFY*04\r\n"].concat();
                assert_eq!(read(&bytes), [Ok(Command::Identify)], "{kept}: {line}");
            }
        }
        for bit in 0..8 * line.len() {
            let mut bytes = line.clone().into_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            for found in read(&bytes) {
                assert!(found.is_err() || found == Ok(command), "{bit}: {line}");
            }
        }
    }
}
