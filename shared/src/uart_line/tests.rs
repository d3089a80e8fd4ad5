//! Lines that the device writes: read, written again, damaged and refused.

use super::alignment::{AlignmentReport, AlignmentState, Quality};
use super::answer::{Accepted, Answer, Binding, Charge, Counts, Identity, Refusal};
use super::calibration::{CalibrationReport, CalibrationState};
use super::command::CommandReader;
use super::emg::EmgReport;
use super::imu::ImuReport;
use super::line::{Line, MAX_LINE_BYTES};
use super::lock::Locking;
use super::*;
use crate::calibration::Shown;
use crate::hid::{Output, Settings};
use crate::installation::InstallationProgress;
use crate::myo::{self, Address, AddressKind, FirmwareVersion, Following, Imu};
use crate::stream::alignment::Alignment;
use crate::stream::lock::LockTimes;
use crate::stream::smoother::{Gate, Reaction};
use alloc::string::{String, ToString};
use alloc::{format, vec, vec::Vec};

/// Bodies of lines: every row of every table, its fields at the ends of what they may hold.
const BODIES: &str = "
    STATE,0,0,0,relax,0,boot,0,0,0 STATE,4294967295,1,2,relax,0,locked,3,4,5,0
    LABEL,2,609,660,close,1,-,0,0,0 LABEL,2,609,660,pinch,1,-,0,0,4294967295,100
    ALIGN,3,660,waiting,0,0,0,-,- ALIGN,97,2550,aligned,255,7,1,0,4294967295
    EMG,1200,0001FF7F80050607,08090A0B0C0D0E0F
    IMU,1200,4000000000000001080000000000FFF000000000
    OK,IDENTIFY,x,-,0123456789ab-dirty,refused,-,-,-
    OK,IDENTIFY,0.1.0,0,y,00000000,00:00:00:00:00:FF,0.65535.1,255
    OK,IDENTIFY,battery,-,- OK,IDENTIFY,battery,4294967295,255
    OK,COUNTERS,0,4294967295,0,1,2,3,4,5,6,7,8,9,10,11,12,13
    OK,ALIGN,begin OK,ALIGN,cancel OK,ALIGN,set OK,ALIGN,state,0,0
    OK,RAW,on OK,RAW,off OK,IMU,on OK,IMU,off OK,STRENGTH,on OK,STRENGTH,off
    OK,BIND,built-in,FA:12:34:56:78:9A,0 OK,BIND,bound,FA:12:34:56:78:9A,1
    OK,BIND,strongest,-,1 OK,BIND,nobody,-,0 OK,BIND,pairing,-,1
    OK,GATE,-,-,- OK,GATE,0,-5000,fast OK,GATE,5000,5000,late
    OK,LOCK,off OK,LOCK,100,200,0 OK,LOCK,2000,120000,1
    OK,HID,off,-,-,-,-,- OK,HID,on,key:f12,click:right,move:down,button:1,axis:x+
    OK,CALIBRATE,weak,other,-,-,0 OK,CALIBRATE,done,-,812,934,1
    OK,INSTALL,done OK,INSTALL,0 OK,INSTALL,4294967295
    ERR,too-long ERR,frame ERR,checksum,00 ERR,checksum,FF ERR,unknown ERR,arguments ERR,no-model
    ERR,no-stream ERR,built-in ERR,busy ERR,no-room ERR,length ERR,block ERR,not-begun ERR,model ERR,flash
";

/// A line around any body, with the right checksum.
pub(super) fn line(body: &str) -> String {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n")
}

#[test]
fn what_is_read_is_written_back_and_is_no_command() {
    for body in BODIES.split_whitespace() {
        let text = line(body);
        let read = Line::parse(text.as_bytes());
        assert_eq!(read.map(|line| line.to_string()), Ok(text.clone()));
        is_no_command(&text);
    }
}

/// A receiver at its own transmitter does not answer itself.
fn is_no_command(text: &str) {
    let mut reader = CommandReader::default();
    let answer = text.bytes().find_map(|byte| reader.push(byte));
    assert_eq!(answer, None, "{text}");
}

#[test]
fn a_line_with_a_changed_byte_or_without_its_end_is_never_read() {
    for text in BODIES.split_whitespace().map(line) {
        for place in 0..text.len() {
            let mut bytes = text.clone().into_bytes();
            assert!(Line::parse(&bytes[..place]).is_err(), "{place}: {text}");
            for flips in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                bytes[place] ^= flips;
                assert!(Line::parse(&bytes).is_err(), "{place}, {flips}: {text}");
                bytes[place] ^= flips;
            }
        }
    }
}

#[test]
fn lines_of_the_documentation_are_read() {
    for module in [
        include_str!("../uart_line.rs"),
        include_str!("alignment.rs"),
        include_str!("answer.rs"),
        include_str!("emg.rs"),
        include_str!("imu.rs"),
        include_str!("../../../docs/uart.md"),
    ] {
        let lines = module.lines().map(|line| line.trim_start_matches("//! "));
        let lines: Vec<_> = lines.filter(|line| line.starts_with('$')).collect();
        assert!(!lines.is_empty());
        for shown in lines {
            let text = format!("{shown}\r\n");
            assert!(Line::parse(text.as_bytes()).is_ok(), "{shown}");
        }
    }
}

#[test]
fn no_line_is_longer_than_its_bound() {
    let longest = |names: &[&'static str]| names.iter().copied().max_by_key(|name| name.len());
    let cause = longest(&Cause::ALL.map(Cause::name)).unwrap();
    let state = longest(&AlignmentState::ALL.map(AlignmentState::name)).unwrap();
    let most = u32::MAX;
    let counts = vec![most.to_string(); 16].join(",");
    for (bytes, body) in [
        (
            103,
            format!("STATE,{most},{most},{most},relax,0,{cause},{most},{most},{most},100"),
        ),
        (
            77,
            format!("ALIGN,{most},{most},{state},255,7,1,{most},{most}"),
        ),
        (54, format!("EMG,{most},{0},{0}", "F".repeat(16))),
        (61, format!("IMU,{most},{}", "F".repeat(40))),
        (193, format!("OK,COUNTERS,{counts}")),
        (
            111,
            format!(
                "OK,IDENTIFY,100.100.100,0123456789ab-dirty,nrf52840-s140,ffffffff,{ADDRESS},65535.65535.65535,100"
            ),
        ),
    ] {
        let text = line(&body);
        assert!(Line::parse(text.as_bytes()).is_ok(), "{text}");
        assert_eq!(text.len(), bytes, "{text}");
        assert!(text.len() <= MAX_LINE_BYTES);
        is_no_command(&text);
    }
}

const ADDRESS: Address = Address {
    kind: AddressKind::Public,
    bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
};

#[test]
fn fields_of_reports_have_their_places() {
    let boot = Report {
        kind: ReportKind::State,
        sequence: 1,
        instant: SampleIndex(2),
        emitted: SampleIndex(3),
        status: Status::Safe(Cause::Boot),
        counters: Counters {
            lost: 4,
            bridged: 5,
            resets: 6,
        },
        strength: None,
    };
    let label = Report {
        kind: ReportKind::Label,
        status: Status::Valid(Intent::Close),
        strength: Percent::new(64),
        ..boot
    };
    let aligned = AlignmentReport {
        sequence: 97,
        emitted: SampleIndex(2550),
        state: AlignmentState::Aligned,
        gestures: 2,
        alignment: Alignment::new(5, true),
        quality: Some(Quality {
            distance: 214,
            margin: 1130,
        }),
    };
    let emg = EmgReport {
        first: SampleIndex(1200),
        samples: [
            [0, 1, -1, 127, -128, 5, 6, 7],
            [8, 9, 10, 11, 12, 13, 14, 15],
        ],
    };
    let imu = ImuReport {
        sample: SampleIndex(1200),
        imu: Imu([16_384, 0, 0, 1, 2048, 0, 0, -16, 0, 0]),
    };
    #[rustfmt::skip]
    let table = [
        (Line::Report(boot), "STATE,1,2,3,relax,0,boot,4,5,6"),
        (Line::Report(label), "LABEL,1,2,3,close,1,-,4,5,6,64"),
        (Line::Alignment(aligned), "ALIGN,97,2550,aligned,2,5,1,214,1130"),
        (Line::Emg(emg), "EMG,1200,0001FF7F80050607,08090A0B0C0D0E0F"),
        (Line::Imu(imu), "IMU,1200,4000000000000001080000000000FFF000000000"),
    ];
    for (value, body) in table {
        assert_eq!(Line::parse(line(body).as_bytes()), Ok(value), "{body}");
    }
}

#[test]
fn fields_of_answers_have_their_places() {
    let identity = Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "nrf52840-s140",
        model: Some(0x5f3a_0c11),
        armband: Some(ADDRESS),
        firmware: Some(FirmwareVersion {
            major: 1,
            minor: 5,
            patch: 1970,
            hardware: 0,
        }),
        battery: Some(80),
    };
    let charge = Charge {
        millivolts: 3790,
        percent: 48,
    };
    let counts = Counts {
        session: myo::Counters {
            connections: 1,
            foreign: 13,
            ..myo::Counters::default()
        },
        packets_dropped: 14,
        lines_dropped: 15,
        emg_dropped: 16,
    };
    let binding = |following, is_kept| Answer::Binding(Binding { following, is_kept });
    let gate = Gate {
        entry: Some(1),
        other: Some(-2),
        reaction: Some(Reaction::Steady),
    };
    let lock = Locking {
        times: LockTimes {
            sign: 500,
            rest: 2000,
        },
        locked: true,
    };
    let outputs = Settings {
        on: true,
        outputs: ["key:w", "click:left", "", "", "axis:x-"].map(Output::from_name),
    };
    let weak = CalibrationReport::of(CalibrationState::Weak, Some(Shown::Other));
    let done = CalibrationReport::judged(CalibrationState::Done, [0.812, 0.9344]);
    #[rustfmt::skip]
    let table = [
        (Answer::Identity(identity), IDENTITY),
        (Answer::Battery(Some(charge)), "OK,IDENTIFY,battery,3790,48"),
        (Answer::Counts(counts), "OK,COUNTERS,1,0,0,0,0,0,0,0,0,0,0,0,13,14,15,16"),
        (Answer::Align(Accepted::Begin), "OK,ALIGN,begin"),
        (Answer::Alignment(Alignment::new(3, true)), "OK,ALIGN,state,3,1"),
        (Answer::Raw(true), "OK,RAW,on"),
        (Answer::Imu(true), "OK,IMU,on"),
        (Answer::Strength(false), "OK,STRENGTH,off"),
        (binding(Following::Bound(ADDRESS), true), "OK,BIND,bound,FA:12:34:56:78:9A,1"),
        (binding(Following::Pinned(ADDRESS), false), "OK,BIND,built-in,FA:12:34:56:78:9A,0"),
        (binding(Following::Strongest, true), "OK,BIND,strongest,-,1"),
        (binding(Following::Nobody, false), "OK,BIND,nobody,-,0"),
        (binding(Following::Pairing, true), "OK,BIND,pairing,-,1"),
        (Answer::Gate(gate), "OK,GATE,1,-2,steady"),
        (Answer::Lock(Some(lock)), "OK,LOCK,500,2000,1"),
        (Answer::Lock(None), "OK,LOCK,off"),
        (Answer::Hid(outputs), "OK,HID,on,key:w,click:left,-,-,axis:x-"),
        (Answer::Calibration(weak, false), "OK,CALIBRATE,weak,other,-,-,0"),
        (Answer::Calibration(done, true), "OK,CALIBRATE,done,-,812,934,1"),
        (Answer::Install(InstallationProgress::Next(1355)), "OK,INSTALL,1355"),
        (Answer::Install(InstallationProgress::Installed), "OK,INSTALL,done"),
        (Answer::Refused(Refusal::Checksum(0x4c)), "ERR,checksum,4C"),
    ];
    for (answer, body) in table {
        assert_eq!(Answer::parse(line(body).as_bytes()), Ok(answer), "{body}");
    }
}

const IDENTITY: &str =
    "OK,IDENTIFY,0.1.0,0123456789ab,nrf52840-s140,5f3a0c11,FA:12:34:56:78:9A,1.5.1970,80";
const STATE: &str = "STATE,0,0,0,relax,0,boot,0,0,0";
const ALIGN: &str = "ALIGN,3,660,waiting,0,0,0,-,-";
const EMG: &str = "EMG,1200,0001FF7F80050607,08090A0B0C0D0E0F";
const IMU: &str = "IMU,1200,4000000000000001080000000000FFF000000000";

/// The name of a body's first wrong field; `fields` if their number is wrong.
fn wrong_field(body: &str) -> &'static str {
    match Line::parse(line(body).as_bytes()) {
        Err(ParseError::Field { field }) => field,
        Err(ParseError::Fields { .. }) => "fields",
        other => panic!("{body}: {other:?}"),
    }
}

#[test]
fn each_wrong_field_of_a_line_is_named() {
    for (body, from, to, field) in [
        (STATE, "STATE", "STATUS", "kind"),
        (STATE, ",0,0,0,", ",00,0,0,", "sequence"),
        (STATE, ",0,0,0,", ",0,+1,0,", "instant"),
        (STATE, ",0,0,0,", ",0,0,4294967296,", "emitted"),
        (STATE, "relax", "fist", "label"),
        (STATE, "relax", "open", "label"),
        (STATE, "0,boot", "2,boot", "valid"),
        (STATE, "0,boot", "1,boot", "cause"),
        (STATE, "boot", "-", "cause"),
        (STATE, "boot,0", "boot,", "lost"),
        (STATE, "boot,0,0", "boot,0,x", "bridged"),
        (STATE, "boot,0,0,0", "boot,0,0,-1", "resets"),
        (STATE, "boot,0,0,0", "boot,0,0,0,101", "strength"),
        (STATE, "boot,0,0,0", "boot,0,0,0,07", "strength"),
        (STATE, ",relax,0,boot,0,0,0", "", "fields"),
        (ALIGN, ",3,", ",03,", "sequence"),
        (ALIGN, "660", "x", "emitted"),
        (ALIGN, "waiting", "wait", "state"),
        (ALIGN, "waiting,0", "waiting,256", "gestures"),
        (ALIGN, "0,0,0", "0,8,0", "turn"),
        (ALIGN, "0,0,0", "0,0,2", "mirrored"),
        (ALIGN, "-,-", "-,1", "distance"),
        (ALIGN, "-,-", "1,-", "margin"),
        (ALIGN, "-,-", "-", "fields"),
        (EMG, "1200", "01200", "first"),
        (EMG, "0001", "001", "older"),
        (EMG, "0001", "00010", "older"),
        (EMG, "0001", "000x", "older"),
        (EMG, "0E0F", "0e0F", "newer"),
        (EMG, ",0001FF", "", "fields"),
        (IMU, "1200", "01200", "sample"),
        (IMU, "0000000", "000000", "imu"),
        (IMU, "FFF0", "fff0", "imu"),
        (IDENTITY, ",0.1.0,", ",,", "version"),
        (IDENTITY, "0123456789ab", "01 23", "revision"),
        (IDENTITY, "nrf52840-s140", "$", "image"),
        (IDENTITY, "5f3a0c11", "5F3A0C11", "model"),
        (IDENTITY, "5f3a0c11", "5f3a0c1", "model"),
        (IDENTITY, "5f3a0c11", "-", "model"),
        (IDENTITY, "FA:12", "fa:12", "armband"),
        (IDENTITY, ":9A", "", "armband"),
        (IDENTITY, "1.5.1970", "1.5", "firmware"),
        (IDENTITY, "1.5.1970", "1.5.1970.2", "firmware"),
        (IDENTITY, "1.5.1970", "1.5.65536", "firmware"),
        (IDENTITY, "1.5.1970", "1.05.1970", "firmware"),
        (IDENTITY, ",80", ",256", "battery"),
        (IDENTITY, ",80", ",", "battery"),
        (IDENTITY, ",80", "", "fields"),
    ] {
        let wrong = body.replacen(from, to, 1);
        assert_eq!(wrong_field(&wrong), field, "{wrong}");
    }
}

#[test]
fn each_wrong_field_of_an_answer_is_named() {
    for (body, field) in [
        ("", "kind"),
        ("REBOOT", "kind"),
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
        assert_eq!(wrong_field(body), field, "{body}");
    }
}

#[test]
fn what_is_no_line_has_its_reason() {
    let refused = |text: &str| Line::parse(text.as_bytes()).unwrap_err();
    for text in [
        "",
        STATE,
        line(STATE).trim_end(),
        &line("\u{e4}"),
        "$ERR,frame\r\n",
        "hello\r\n",
        "# caf\u{e9}\r\n",
        "# \u{7}\r\n",
        "# a\n",
    ] {
        assert_eq!(refused(text), ParseError::Frame, "{text}");
    }
    let (expected, found) = (0x3f, 0);
    let checksum = ParseError::Checksum { expected, found };
    assert_eq!(refused(&format!("${STATE}*00\r\n")), checksum);
    let (expected, found) = (10, 4);
    let fields = ParseError::Fields { expected, found };
    assert_eq!(refused(&line("STATE,0,0,0")), fields);
    // A body whose row has two words.
    let (expected, found) = (9, 8);
    let fields = ParseError::Fields { expected, found };
    let cut = IDENTITY.strip_suffix(",80").unwrap();
    assert_eq!(refused(&line(cut)), fields);
}
