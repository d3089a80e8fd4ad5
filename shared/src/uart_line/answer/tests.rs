//! Answers written, read and refused.

use super::*;
use crate::calibration::Shown;
use crate::hid::Output;
use crate::myo::{AddressKind, Counters};
use crate::uart_line::calibration::CalibrationState;
use crate::uart_line::tests::line;
use alloc::string::ToString;

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
    let weak = CalibrationReport::of(CalibrationState::Weak, Some(Shown::Other));
    let done = CalibrationReport::judged(CalibrationState::Done, [0.812, 0.9344]);
    for (answer, body) in [
        (
            Answer::Identity(unknown),
            "OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,refused,-,-,-",
        ),
        (
            Answer::Battery(Some(Charge {
                millivolts: 3790,
                percent: 48,
            })),
            "OK,IDENTIFY,battery,3790,48",
        ),
        (Answer::Battery(None), "OK,IDENTIFY,battery,-,-"),
        (
            Answer::Counts(counts),
            "OK,COUNTERS,1,0,0,0,0,0,0,0,0,0,0,0,13,14,15,4294967295",
        ),
        (Answer::Align(Accepted::Begin), "OK,ALIGN,begin"),
        (Answer::Align(Accepted::Cancel), "OK,ALIGN,cancel"),
        (Answer::Align(Accepted::Set), "OK,ALIGN,set"),
        (
            Answer::Alignment(Alignment::new(3, true)),
            "OK,ALIGN,state,3,1",
        ),
        (Answer::Raw(true), "OK,RAW,on"),
        (Answer::Raw(false), "OK,RAW,off"),
        (Answer::Imu(true), "OK,IMU,on"),
        (Answer::Refused(Refusal::NoRoom), "ERR,no-room"),
        (Answer::Strength(true), "OK,STRENGTH,on"),
        (
            binding(Following::Bound(IDENTITY.armband.unwrap()), true),
            "OK,BIND,bound,FA:12:34:56:78:9A,1",
        ),
        (binding(Following::Nobody, false), "OK,BIND,nobody,-,0"),
        (binding(Following::Pairing, true), "OK,BIND,pairing,-,1"),
        (binding(Following::Strongest, true), "OK,BIND,strongest,-,1"),
        (
            Answer::Calibration(weak, false),
            "OK,CALIBRATE,weak,other,-,-,0",
        ),
        (
            Answer::Calibration(done, true),
            "OK,CALIBRATE,done,-,812,934,1",
        ),
        (Answer::Hid(Settings::OFF), "OK,HID,off,-,-,-,-,-"),
        (
            Answer::Hid(Settings {
                on: true,
                outputs: ["key:w", "click:left", "", "", "axis:x-"].map(Output::from_name),
            }),
            "OK,HID,on,key:w,click:left,-,-,axis:x-",
        ),
        (
            Answer::Install(InstallationProgress::Next(1355)),
            "OK,INSTALL,1355",
        ),
        (
            Answer::Install(InstallationProgress::Installed),
            "OK,INSTALL,done",
        ),
        (Answer::Refused(Refusal::TooLong), "ERR,too-long"),
        (Answer::Refused(Refusal::NoModel), "ERR,no-model"),
    ] {
        assert_eq!(answer.to_string(), line(body));
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

fn refused(body: &str) -> ParseError {
    Answer::parse(line(body).as_bytes()).unwrap_err()
}

const IDENTITY_BODY: &str =
    "OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80";

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
        assert_eq!(refused(&IDENTITY_BODY.replacen(from, to, 1)), wrong(field));
    }
    let fields = ParseError::Fields {
        expected: 9,
        found: 8,
    };
    assert_eq!(refused(&IDENTITY_BODY.replacen(",80", "", 1)), fields);
}

#[test]
fn every_other_refusal_is_named() {
    for (body, field) in [
        ("", "kind"),
        ("LABEL,1", "kind"),
        ("OK", "command"),
        ("OK,REBOOT", "command"),
        ("OK,IDENTIFY,battery,3790,-", "percent"),
        ("OK,IDENTIFY,battery,3790", "fields"),
        ("OK,ALIGN,set,3,0", "fields"),
        ("OK,ALIGN,waiting", "align"),
        ("OK,ALIGN,state,8,0", "turn"),
        ("OK,ALIGN,state,3", "fields"),
        ("OK,GATE,-1,0,-", "entry"),
        ("OK,GATE,0,5001,-", "other"),
        ("OK,GATE,0,0,slow", "reaction"),
        ("OK,CALIBRATE,tired,-,-,-,0", "state"),
        ("OK,CALIBRATE,weak,fist,-,-,0", "cue"),
        ("OK,CALIBRATE,done,-,-,1,1", "before"),
        ("OK,CALIBRATE,done,-,1,2,2", "in_use"),
        ("OK,INSTALL,-", "block"),
        ("OK,RAW", "fields"),
        ("OK,RAW,1", "raw"),
        ("OK,BIND,bound,-,1", "address"),
        ("OK,BIND,nobody,FA:12:34:56:78:9A,1", "address"),
        ("OK,BIND,bound,FA:12:34:56:78,1", "address"),
        ("OK,BIND,friend,-,1", "why-this"),
        ("OK,BIND,nobody,-,2", "kept"),
        ("OK,COUNTERS,1", "fields"),
        (
            "OK,COUNTERS,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,01",
            "emg_dropped",
        ),
        ("ERR", "why"),
        ("ERR,tired", "why"),
        ("ERR,checksum", "fields"),
        ("ERR,checksum,4", "expected"),
        ("ERR,checksum,0a", "expected"),
        ("ERR,frame,04", "fields"),
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
