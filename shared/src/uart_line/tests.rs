//! Lines written, parsed and damaged.

use super::*;
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use proptest::prelude::*;

const BOOT: Report = Report {
    kind: Kind::State,
    sequence: 0,
    instant: SampleIndex(0),
    emitted: SampleIndex(0),
    status: Status::Safe(Cause::Boot),
    counters: Counters {
        lost: 0,
        bridged: 0,
        resets: 0,
    },
};

fn any_status() -> impl Strategy<Value = Status> {
    prop_oneof![
        prop::sample::select(&Intent::ALL[..]).prop_map(Status::Valid),
        prop::sample::select(&Cause::ALL[..]).prop_map(Status::Safe),
    ]
}

fn any_report() -> impl Strategy<Value = Report> {
    let kind = prop_oneof![Just(Kind::Label), Just(Kind::State)];
    (kind, any::<[u32; 6]>(), any_status()).prop_map(|(kind, numbers, status)| {
        let [sequence, instant, emitted, lost, bridged, resets] = numbers;
        Report {
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
        }
    })
}

/// Text of 1 to `most` of these letters.
fn text(letters: &'static str, most: usize) -> impl Strategy<Value = String> {
    let letter = prop::sample::select(letters.as_bytes()).prop_map(char::from);
    prop::collection::vec(letter, 1..=most).prop_map(String::from_iter)
}

/// Fields like those of a line, some of them out of range or misspelt.
fn likely_body() -> impl Strategy<Value = String> {
    // "0" more often than by chance: it is the only number that begins with 0.
    let number = || prop_oneof![Just(String::from("0")), text("0123456789", 11)];
    let word = |words: &'static [&'static str]| prop::sample::select(words);
    (
        word(&["LABEL", "STATE"]),
        [number(), number(), number()],
        word(&["relax", "open", "fist"]),
        word(&["0", "1", "2"]),
        word(&["-", "boot", "dog"]),
        [(); 3].map(|()| text("0123456789+", 3)),
    )
        .prop_map(|(kind, numbers, label, valid, cause, counters)| {
            let (numbers, counters) = (numbers.join(","), counters.join(","));
            format!("{kind},{numbers},{label},{valid},{cause},{counters}")
        })
}

/// A line around any body, with the right checksum.
fn line(body: &str) -> String {
    format!("${body}*{:02X}\r\n", checksum(body))
}

/// Bytes of the longest line, line end included.
const MAX_LINE: usize = 99;

proptest! {
    #[test]
    fn what_is_written_is_read_back(report in any_report()) {
        let line = report.to_string();
        prop_assert!(line.is_ascii() && line.len() <= MAX_LINE);
        prop_assert_eq!(Report::parse(line.as_bytes()), Ok(report));
    }

    #[test]
    fn a_changed_byte_is_never_read(report in any_report(), place: usize, flips in 1u8..) {
        let mut bytes = report.to_string().into_bytes();
        let place = place % bytes.len();
        bytes[place] ^= flips;
        prop_assert!(Report::parse(&bytes).is_err());
    }

    #[test]
    fn a_cut_line_is_never_read(report in any_report(), kept: usize) {
        let line = report.to_string();
        prop_assert!(Report::parse(&line.as_bytes()[..kept % line.len()]).is_err());
    }

    #[test]
    fn arbitrary_bytes_are_refused_or_written_back(bytes: Vec<u8>) {
        if let Ok(report) = Report::parse(&bytes) {
            prop_assert_eq!(report.to_string().into_bytes(), bytes);
        }
    }

    /// As above, but past the frame and the checksum.
    #[test]
    fn arbitrary_fields_are_refused_or_written_back(
        body in likely_body(),
    ) {
        let text = line(&body);
        if let Ok(report) = Report::parse(text.as_bytes()) {
            prop_assert_eq!(report.to_string(), text);
        }
    }
}

#[test]
fn lines_are_those_of_the_module_documentation() {
    let label = Report {
        kind: Kind::Label,
        sequence: 2,
        instant: SampleIndex(609),
        emitted: SampleIndex(660),
        status: Status::Valid(Intent::Close),
        ..BOOT
    };
    let module = include_str!("../uart_line.rs");
    for report in [BOOT, label] {
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
            kind: Kind::Label,
            sequence: full,
            instant: SampleIndex(full),
            emitted: SampleIndex(full),
            status,
            counters: Counters {
                lost: full,
                bridged: full,
                resets: full,
            },
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
    ] {
        assert_eq!(refused(&line(body)), field(name), "{body}");
    }
}
