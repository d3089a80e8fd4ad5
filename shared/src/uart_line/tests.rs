//! Lines written, parsed and damaged.

use super::alignment::{AlignmentReport, AlignmentState};
use super::answer::{Accepted, Answer, Binding, Charge, Identity, Refusal};
use super::command::CommandReader;
use super::emg::EmgReport;
use super::imu::ImuReport;
use super::line::{Line, MAX_LINE_BYTES};
use super::lock::Locking;
use super::*;
use crate::hid::{self, Output};
use crate::installation::InstallationProgress;
use crate::myo::{Address, AddressKind, FirmwareVersion, Following, Imu};
use crate::stream::alignment::Alignment;
use crate::stream::lock::LockTimes;
use crate::stream::smoother::{Gate, Reaction};
use crate::units::Sample;
use alloc::string::{String, ToString};
use alloc::{format, vec};
use proptest::prelude::*;

const BOOT: Report = Report {
    kind: ReportKind::State,
    sequence: 0,
    instant: SampleIndex(0),
    emitted: SampleIndex(0),
    status: Status::Safe(Cause::Boot),
    counters: Counters {
        lost: 0,
        bridged: 0,
        resets: 0,
    },
    strength: None,
};

fn any_status() -> impl Strategy<Value = Status> {
    prop_oneof![
        prop::sample::select(&Intent::ALL[..]).prop_map(Status::Valid),
        prop::sample::select(&Cause::ALL[..]).prop_map(Status::Safe),
    ]
}

fn any_report() -> impl Strategy<Value = Line<'static>> {
    let kind = prop_oneof![Just(ReportKind::Label), Just(ReportKind::State)];
    let strength = prop::option::of(0..=100_u8);
    (kind, any::<[u32; 6]>(), any_status(), strength).prop_map(
        |(kind, numbers, status, strength)| {
            let strength = strength.and_then(Percent::new);
            let [sequence, instant, emitted, lost, bridged, resets] = numbers;
            Line::Report(Report {
                kind,
                sequence,
                instant: SampleIndex(instant),
                emitted: SampleIndex(emitted),
                status,
                counters: Counters {
                    lost,
                    bridged,
                    resets,
                },
                strength,
            })
        },
    )
}

prop_compose! {
    fn any_placement()(turn in 0_u8..8, mirrored: bool) -> Alignment {
        Alignment::new(turn, mirrored)
    }
}

prop_compose! {
    fn any_alignment()(
        (sequence, emitted, gestures) in any::<(u32, u32, u8)>(),
        state in prop::sample::select(&AlignmentState::ALL[..]),
        alignment in any_placement(),
        quality: Option<(u32, u32)>,
    ) -> Line<'static> {
        let emitted = SampleIndex(emitted);
        Line::Alignment(AlignmentReport { sequence, emitted, state, gestures, alignment, quality })
    }
}

prop_compose! {
    fn any_emg()(first: u32, samples: [Sample; 2]) -> Line<'static> {
        Line::Emg(EmgReport { first: SampleIndex(first), samples })
    }
}

prop_compose! {
    fn any_imu()(sample: u32, imu: [i16; 10]) -> Line<'static> {
        Line::Imu(ImuReport { sample: SampleIndex(sample), imu: Imu(imu) })
    }
}

prop_compose! {
    fn any_address()(bytes: [u8; 6]) -> Address {
        Address { kind: AddressKind::Public, bytes }
    }
}

prop_compose! {
    fn any_identity()(
        words in [(); 3].map(|()| prop::sample::select(&["0.1.0", "0123456789ab-dirty", "-", "x"][..])),
        model: Option<u32>,
        armband in prop::option::of(any_address()),
        firmware: Option<[u16; 3]>,
        battery: Option<u8>,
    ) -> Answer<'static> {
        let [version, revision, image] = words;
        let firmware = firmware.map(|[major, minor, patch]| FirmwareVersion { major, minor, patch, hardware: 0 });
        Answer::Identity(Identity { version, revision, image, model, armband, firmware, battery })
    }
}

prop_compose! {
    fn any_counts()(numbers: [u32; 16]) -> Answer<'static> {
        let body = numbers.map(|number| number.to_string()).join(",");
        let line = line(&format!("OK,COUNTERS,{body}"));
        let Ok(Answer::Counts(counts)) = Answer::parse(line.as_bytes()) else {
            panic!("{line}");
        };
        assert_eq!(counts.numbers(), numbers);
        Answer::Counts(counts)
    }
}

const REFUSALS: [Refusal; 11] = [
    Refusal::NoRoom,
    Refusal::TooLong,
    Refusal::Frame,
    Refusal::Unknown,
    Refusal::Arguments,
    Refusal::NoModel,
    Refusal::NoStream,
    Refusal::BuiltIn,
    Refusal::Busy,
    Refusal::Length,
    Refusal::Flash,
];

fn any_outputs() -> impl Strategy<Value = hid::Settings> {
    let names = [
        "",
        "key:f12",
        "click:right",
        "move:down",
        "button:1",
        "axis:x+",
    ];
    let output = prop::sample::select(names.map(Output::from_name).to_vec());
    (any::<bool>(), prop::array::uniform5(output))
        .prop_map(|(on, outputs)| hid::Settings { on, outputs })
}

fn any_answer() -> impl Strategy<Value = Line<'static>> {
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
    let reaction = prop::option::of(prop::sample::select(&Reaction::ALL[..]));
    let gate = (margin(0), margin(-5000), reaction).prop_map(|(entry, other, reaction)| {
        Answer::Gate(Gate {
            entry,
            other,
            reaction,
        })
    });
    let answer = prop_oneof![
        any_identity(),
        any::<Option<(u32, u8)>>().prop_map(|charge| Answer::Battery(charge.map(
            |(millivolts, percent)| Charge {
                millivolts,
                percent
            }
        ))),
        any_counts(),
        binding,
        gate,
        any_placement().prop_map(Answer::Alignment),
        any::<bool>().prop_map(Answer::Raw),
        any::<bool>().prop_map(Answer::Imu),
        any::<bool>().prop_map(Answer::Strength),
        any::<u32>().prop_map(|block| Answer::Install(InstallationProgress::Next(block))),
        Just(Answer::Install(InstallationProgress::Installed)),
        Just(Answer::Align(Accepted::Begin)),
        Just(Answer::Align(Accepted::Cancel)),
        Just(Answer::Align(Accepted::Set)),
        any::<u8>().prop_map(|sum| Answer::Refused(Refusal::Checksum(sum))),
        prop::sample::select(&REFUSALS[..]).prop_map(Answer::Refused),
        any_outputs().prop_map(Answer::Hid),
        any::<Option<(bool, [u16; 2])>>().prop_map(|lock| Answer::Lock(lock.map(
            |(locked, [sign, rest])| Locking {
                times: LockTimes {
                    sign: 100 + u32::from(sign) % 1901,
                    rest: 200 + u32::from(rest),
                },
                locked,
            }
        ))),
    ];
    answer.prop_map(Line::Answer)
}

fn any_line() -> impl Strategy<Value = Line<'static>> {
    prop_oneof![
        any_report(),
        any_alignment(),
        any_emg(),
        any_imu(),
        any_answer()
    ]
}

/// A line around any body, with the right checksum.
pub(super) fn line(body: &str) -> String {
    format!("${body}*{:02X}\r\n", checksum(body))
}

fn checksum(body: &str) -> u8 {
    body.bytes().fold(0, |sum, byte| sum ^ byte)
}

/// Bytes of the longest report, line end included.
const MAX_LINE: usize = 103;

proptest! {
    #[test]
    fn what_is_written_is_read_back(written in any_line()) {
        let line = written.to_string();
        let most = if matches!(written, Line::Report(_)) { MAX_LINE } else { MAX_LINE_BYTES };
        prop_assert!(line.is_ascii() && line.len() <= most);
        prop_assert_eq!(Line::parse(line.as_bytes()), Ok(written));
        prop_assert_eq!(line.matches(['\r', '\n', '$', '*']).count(), 4);
        // A receiver at its own transmitter does not answer itself.
        let mut reader = CommandReader::new();
        prop_assert_eq!(line.bytes().find_map(|byte| reader.push(byte)), None);
    }

    #[test]
    fn a_changed_byte_is_never_read(line in any_line(), place: usize, flips in 1u8..) {
        let mut bytes = line.to_string().into_bytes();
        let place = place % bytes.len();
        bytes[place] ^= flips;
        // `$` may become `#`.
        prop_assert!(matches!(Line::parse(&bytes), Err(_) | Ok(Line::Comment(_))));
    }

    #[test]
    fn a_cut_line_is_never_read(line in any_line(), kept: usize) {
        let line = line.to_string();
        prop_assert!(Line::parse(&line.as_bytes()[..kept % line.len()]).is_err());
    }
}

#[test]
fn lines_are_those_of_the_module_documentation() {
    let label = Report {
        kind: ReportKind::Label,
        sequence: 2,
        instant: SampleIndex(609),
        emitted: SampleIndex(660),
        status: Status::Valid(Intent::Close),
        ..BOOT
    };
    let strong = Report {
        strength: Percent::new(64),
        ..label
    };
    let module = include_str!("../uart_line.rs");
    for report in [BOOT, label, strong] {
        let line = report.to_string();
        let shown = format!("//! {}\n", line.trim_end());
        assert!(
            module.contains(&shown),
            "missing from the module's first lines: {line}"
        );
    }
}

#[test]
fn no_line_is_longer_than_its_bound() {
    let full = u32::MAX;
    let mut longest = 0;
    let statuses = Intent::ALL.map(Status::Valid);
    for status in statuses.into_iter().chain(Cause::ALL.map(Status::Safe)) {
        let report = Report {
            kind: ReportKind::Label,
            sequence: full,
            instant: SampleIndex(full),
            emitted: SampleIndex(full),
            status,
            counters: Counters {
                lost: full,
                bridged: full,
                resets: full,
            },
            strength: Percent::new(100),
        };
        longest = longest.max(report.to_string().len());
    }
    assert_eq!(longest, MAX_LINE);
}

#[test]
fn each_damage_has_its_own_error() {
    let refused = |text: &str| Report::parse(text.as_bytes()).unwrap_err();
    let field = |field| ParseError::Field { field };
    let good = "STATE,0,0,0,relax,0,boot,0,0,0";
    assert_eq!(Report::parse(line(good).as_bytes()), Ok(BOOT));

    assert_eq!(refused(""), ParseError::Frame);
    assert_eq!(refused(good), ParseError::Frame);
    assert_eq!(refused(line(good).trim_end()), ParseError::Frame);
    assert_eq!(refused(&line("ä")), ParseError::Frame);
    let expected = checksum(good);
    assert_eq!(
        refused(&format!("${good}*00\r\n")),
        ParseError::Checksum { expected, found: 0 }
    );
    assert_eq!(
        refused(&line("STATE,0,0,0")),
        ParseError::Fields {
            expected: 10,
            found: 4
        }
    );
    for (body, name) in [
        ("STATUS,0,0,0,relax,0,boot,0,0,0", "kind"),
        ("STATE,00,0,0,relax,0,boot,0,0,0", "sequence"),
        ("STATE,0,+1,0,relax,0,boot,0,0,0", "instant"),
        ("STATE,0,0,4294967296,relax,0,boot,0,0,0", "emitted"),
        ("STATE,0,0,0,fist,0,boot,0,0,0", "label"),
        ("STATE,0,0,0,open,0,boot,0,0,0", "label"),
        ("STATE,0,0,0,relax,2,boot,0,0,0", "valid"),
        ("STATE,0,0,0,relax,1,boot,0,0,0", "cause"),
        ("STATE,0,0,0,relax,0,-,0,0,0", "cause"),
        ("STATE,0,0,0,relax,0,boot,,0,0", "lost"),
        ("STATE,0,0,0,relax,0,boot,0,x,0", "bridged"),
        ("STATE,0,0,0,relax,0,boot,0,0,-1", "resets"),
        ("STATE,0,0,0,relax,0,boot,0,0,0,101", "strength"),
        ("LABEL,0,0,0,open,1,-,0,0,0,07", "strength"),
    ] {
        assert_eq!(refused(&line(body)), field(name), "{body}");
    }
}
