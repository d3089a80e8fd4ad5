//! Descriptions that are read and refused, and the recordings that come of them. All inputs are made here.

use std::path::Path;

use shared::intent::Intent;
use tempfile::TempDir;

use super::*;
use crate::labels::activity;
use crate::recording::movement::{Movement, MovementKind};
use crate::{Library, LoadError, LoadOptions, Timing, load, npy, runs};

const R: Option<Intent> = Some(Intent::Relax);
const O: Option<Intent> = Some(Intent::Open);
const C: Option<Intent> = Some(Intent::Close);

/// A folder with these files in it.
fn folder(files: &[(&str, Vec<u8>)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

fn described(text: &str, files: &[(&str, Vec<u8>)]) -> Result<Library, LoadError> {
    let folder = folder(files);
    std::fs::write(folder.path().join(FILE_NAME), text).unwrap();
    load(folder.path(), &LoadOptions::default())
}

/// Counts of a person: noise without repeats, louder where a hold is.
fn count(person: usize, row: usize, channel: usize, hold: &std::ops::Range<usize>) -> i8 {
    let mixed = (row * 8 + channel + 1_000_003 * person) as u32;
    let noise = (mixed.wrapping_mul(2_654_435_761) >> 24) as u8 as i8;
    if hold.contains(&row) {
        noise / 2
    } else {
        noise / 16
    }
}

const HOLD: std::ops::Range<usize> = 200..500;

fn array(person: usize, rows: usize) -> Vec<u8> {
    let counts = (0..rows * 8).map(|at| count(person, at / 8, at % 8, &HOLD).cast_unsigned());
    npy::encode("|i1", &[rows, 8], &counts.collect::<Vec<u8>>())
}

/// A table: rows of what `before` and `after` write around the channels.
fn table(
    head: &str,
    separator: &str,
    rows: usize,
    around: impl Fn(usize) -> (String, String),
) -> Vec<u8> {
    let mut text = head.to_owned();
    for row in 0..rows {
        let counts: Vec<String> = (0..8)
            .map(|c| count(1, row, c, &HOLD).to_string())
            .collect();
        let (before, after) = around(row);
        text += &format!("{before}{}{after}\n", counts.join(separator));
    }
    text.into_bytes()
}

#[test]
fn a_description_that_cannot_be_used_names_file_line_and_field() {
    let files = "files = \"{person}/{trial}.csv\"\n";
    for (text, line, words) in [
        (
            format!("{files}rate = 200\nfoo = 1\n"),
            Some(3),
            "unknown field `foo`, expected one of `folder`, `files`",
        ),
        ("rate = 200\n".to_owned(), Some(1), "missing field `files`"),
        (files.to_owned(), Some(1), "missing field `rate`"),
        (
            format!("{files}rate = 100\n"),
            Some(2),
            "expected 200 rows a second, found 100",
        ),
        (format!("{files}rate = \"fast\"\n"), Some(2), "invalid type"),
        (
            format!("{files}rate = 200\nscale = 0\n"),
            Some(3),
            "counts of one unit",
        ),
        (
            format!("{files}rate = 200\nrectified = true\n"),
            Some(3),
            "EMG mode 2",
        ),
        (
            format!("{files}rate = 200\narm = \"middle\"\n"),
            Some(3),
            "expected `right` or `left`",
        ),
        (
            format!("{files}rate = 200\nrotation = 8\n"),
            Some(3),
            "0 to 7 places, found 8",
        ),
        (
            format!("{files}rate = 200\nseparator = \"|\"\n"),
            Some(3),
            "found \"|\"",
        ),
        (
            format!("{files}rate = 200\nchannels = [1, 2, 3]\n"),
            Some(3),
            "found 3 columns",
        ),
        (
            format!("{files}rate = 200\nchannels = [1, 2, 3, 4, 5, 6, 7, 7]\n"),
            Some(3),
            "one of them twice",
        ),
        (
            format!("{files}rate = 200\nchannels = [\"a\", 2, 3, 4, 5, 6, 7, 8]\n"),
            Some(3),
            "names and numbers",
        ),
        (
            format!("{files}rate = 200\nchannels = [0, 1, 2, 3, 4, 5, 6, 7]\n"),
            Some(3),
            "from 1 on, found 0",
        ),
        (
            format!("{files}rate = 200\ntiming = \"late\"\n"),
            Some(3),
            "`cues`, `muscle`, `from-activity`",
        ),
        (
            format!("{files}rate = 200\ncue_lag_ms = -5\n"),
            Some(3),
            "0 to 2000 ms, found -5",
        ),
        (
            format!("{files}rate = 200\nlabels = {{ fist = [1] }}\n"),
            Some(3),
            "found \"fist\"",
        ),
        (
            "files = \"{peron}.csv\"\nrate = 200\n".to_owned(),
            Some(1),
            "found {peron}",
        ),
        ("files = [\n".to_owned(), Some(1), "recordings.toml"),
        (
            format!("{files}rate = 200\nlabel = \"gt\"\n"),
            None,
            "needs `labels`",
        ),
        (
            format!("{files}rate = 200\nlabels = {{ open = [1] }}\n"),
            None,
            "{gesture} in `files`, `label` or `label_files`",
        ),
        (
            format!(
                "{files}rate = 200\nlabel = 9\nlabel_files = \"{{trial}}.txt\"\nlabels = {{ open = [1] }}\n"
            ),
            None,
            "both",
        ),
        (
            format!(
                "{files}rate = 200\nlabel_files = \"{{session}}.txt\"\nlabels = {{ open = [1] }}\n"
            ),
            None,
            "found {session}",
        ),
        (
            format!("{files}rate = 200\ntiming = \"from-activity\"\n"),
            None,
            "needs {gesture} in `files`",
        ),
        (
            format!("{files}rate = 200\ntiming = \"muscle\"\ncue_lag_ms = 100\n"),
            None,
            "needs timing = \"cues\"",
        ),
        (
            format!("{files}rate = 200\nseparator = \";\"\n"),
            None,
            "needs `channels`",
        ),
        (
            format!(
                "{files}rate = 200\nheader = false\nchannels = [1,2,3,4,5,6,7,8]\ntime = \"t\"\n"
            ),
            None,
            "columns by number",
        ),
        (
            format!("{files}rate = 200\nfolder = \"nowhere\"\n"),
            None,
            "found none at",
        ),
    ] {
        let error = described(&text, &[]).unwrap_err();
        let LoadError::Description(found) = &error else {
            panic!("{text}: {error}");
        };
        assert_eq!(found.line, line, "{text}: {error}");
        let error = error.to_string();
        assert!(
            error.contains(words) && error.contains("recordings.toml"),
            "{text}: {error}"
        );
    }
}

#[test]
fn channels_come_in_any_order_with_time_and_words() {
    let text = "files = \"{person}.csv\"\nrate = 200\nseparator = \";\"\nheader = true\n\
                channels = [\"h\", \"g\", \"f\", \"e\", \"d\", \"c\", \"b\", \"a\"]\ntime = \"when\"\nlabel = \"what\"\n\
                labels = { relax = [\"zzz\"], open = [\"auf\"], point = [\"zeig\"], unknown = [\"\"] }\nscale = 128\n";
    let word = |row: usize| ["zzz", "auf", "zeig", ""][row / 150 % 4];
    let mut rows = "# ein Kommentar\nwhen;a;b;c;d;e;f;g;h;what\n".to_owned();
    for row in 0..600 {
        let counts: Vec<String> = (0..8)
            .map(|c| format!("{}", f64::from(count(1, row, c, &HOLD)) / 128.0).replace('.', ","))
            .collect();
        rows += &format!("{};{};{}\n", 5 * row, counts.join(";"), word(row));
    }
    let library = described(text, &[("anna.csv", rows.into_bytes())]).unwrap();
    let own = &library.recordings[0];
    assert_eq!(
        (own.full_name().as_str(), own.samples.len()),
        ("react-emg/anna/anna", 600)
    );
    let expected: Vec<i8> = (0..8).rev().map(|c| count(1, 300, c, &HOLD)).collect();
    assert_eq!(own.samples[300].to_vec(), expected);
    let labels: Vec<_> = runs(&own.labels)
        .iter()
        .map(|run| (run.label, run.samples()))
        .collect();
    assert_eq!(labels, [(R, 150), (O, 150), (None, 300)]);
    assert_eq!(
        own.other_movement,
        [Movement::new(MovementKind::Point, 300..450)]
    );
}

#[test]
fn faults_of_a_file_name_line_and_column() {
    let head = "files = \"{person}.csv\"\nrate = 200\n";
    let numbers = "channels = [1, 2, 3, 4, 5, 6, 7, 8]\n";
    let labelled = format!("{head}{numbers}label = 9\nlabels = {{ relax = [0] }}\n");
    let good = table("", ",", 150, |_| (String::new(), ",0".to_owned()));
    let with = |line: &str| [&good[..], line.as_bytes()].concat();
    for (text, bytes, words) in [
        (
            labelled.clone(),
            with("1,2,3,4,5,6,7,8,7\n"),
            "line 151: expected a label that is listed in `labels`",
        ),
        (
            labelled.clone(),
            with("1,2,3\n"),
            "line 151: expected 9 values",
        ),
        (
            labelled.clone(),
            with("1,2,3,x,5,6,7,8,0\n"),
            "line 151: expected a number in field 4, found \"x\"",
        ),
        (
            labelled.clone(),
            with("1,2,300,4,5,6,7,8,0\n"),
            "line 151: expected a count of the armband in field 3",
        ),
        (
            labelled.replace("label = 9", "label = 10"),
            good.clone(),
            "column number 10 of the description, found 9 columns",
        ),
        (
            labelled.replace("label = 9", "label = \"gt\""),
            good.clone(),
            "column \"gt\"",
        ),
        (
            format!("{head}scale = 1000\n{numbers}"),
            good.clone(),
            "whole multiples of 1000",
        ),
        (
            format!("{head}{numbers}"),
            Vec::new(),
            "expected one row per sample",
        ),
        (
            format!("{head}{numbers}"),
            b"PK\x03\x04".to_vec(),
            "as a description has them, found",
        ),
        (
            format!("{head}{numbers}"),
            npy::encode("|i1", &[50, 7], &[1; 350]),
            "numbers of the columns in the description",
        ),
        (
            head.to_owned(),
            npy::encode("|i1", &[50, 9], &[1; 450]),
            "(50, 9)",
        ),
    ] {
        let library = described(&text, &[("anna.csv", bytes)]);
        let error = match library {
            Ok(library) => library.skipped[0].line(),
            Err(error) => error.line(),
        };
        assert!(
            error.contains(words) && error.contains("anna.csv"),
            "{text}: {error}"
        );
    }
}

#[test]
fn labels_of_a_file_beside_are_read_sample_by_sample() {
    let text = "files = \"{person}/{session}_emg.npy\"\nlabel_files = \"{person}/{session}_ann.txt\"\nrate = 200\n\
                labels = { relax = [0], close = [\"fist\"] }\n";
    let words = |rows: usize| "0\n".repeat(300) + &"fist\n".repeat(rows - 300);
    let files = |rows: usize| {
        [
            ("anna/1_emg.npy", array(1, 700)),
            ("anna/1_ann.txt", words(rows).into_bytes()),
        ]
    };
    let library = described(text, &files(700)).unwrap();
    let found: Vec<_> = runs(&library.recordings[0].labels)
        .iter()
        .map(|run| run.label)
        .collect();
    assert_eq!(found, [R, C]);
    assert!(library.ignored.is_empty(), "{:?}", library.ignored);
    let error = described(text, &files(699)).unwrap().skipped[0].line();
    assert!(
        error.contains("1_ann.txt") && error.contains("699 labels for 700 samples"),
        "{error}"
    );
    let error = described(text, &files(700)[..1]).unwrap().skipped[0].line();
    assert!(
        error.contains("1_emg.npy") && error.contains("1_ann.txt beside it"),
        "{error}"
    );
}

#[test]
fn a_file_of_one_gesture_is_labelled_by_its_name_or_by_the_muscle() {
    let files = [
        ("anna/fist_1.npy", array(1, 1000)),
        ("anna/rest_1.npy", array(2, 700)),
        ("ben/fist_1.npy", array(3, 1000)),
    ];
    let text = |timing: &str| {
        format!(
            "files = \"{{person}}/{{gesture}}_{{trial}}.npy\"\nrate = 200\n{timing}\nlabels = {{ close = [\"fist\"], relax = [\"rest\"] }}\n"
        )
    };
    let library = described(&text(""), &files).unwrap();
    assert_eq!(library.subjects(), ["react-emg/anna", "react-emg/ben"]);
    let first = &library.recordings[0];
    assert_eq!(
        (first.full_name().as_str(), first.timing),
        ("react-emg/anna/fist_1", Timing::Cues)
    );
    assert_eq!(first.labels, vec![C; 1000]);
    assert_eq!(library.recordings[1].labels, vec![R; 700]);
    let library = described(&text("timing = \"from-activity\""), &files).unwrap();
    let first = &library.recordings[0];
    let found = activity::labelled(
        first.data_set,
        "",
        first.samples.clone(),
        crate::labels::motion::Motion::Intent(Intent::Close),
    );
    assert_eq!(
        (&first.labels, first.timing),
        (&found.labels, Timing::Muscle)
    );
    assert_eq!(
        [first.labels[100], first.labels[350], first.labels[900]],
        [R, C, R]
    );
    assert_eq!(library.recordings[1].labels, vec![R; 700]);
}

#[test]
fn a_stated_lag_moves_the_labels_for_good() {
    let text = "files = \"{person}.csv\"\nrate = 200\nchannels = [1,2,3,4,5,6,7,8]\nlabel = 9\ncue_lag_ms = 250\n\
                labels = { relax = [0], other = [2] }\n";
    let rows = table("", " ", 800, |row| {
        (
            String::new(),
            format!(" {}", 2 * usize::from((200..500).contains(&row))),
        )
    });
    let library = described(text, &[("anna.csv", rows)]).unwrap();
    let own = &library.recordings[0];
    assert_eq!(own.timing, Timing::Muscle);
    assert_eq!(
        own.other_movement,
        [Movement::new(MovementKind::Other, 250..550)]
    );
}

#[test]
fn arm_and_rotation_bring_the_channels_into_the_common_frame() {
    for (lines, channel_of) in [
        ("", [0, 1, 2, 3, 4, 5, 6, 7]),
        ("rotation = 3\n", [3, 4, 5, 6, 7, 0, 1, 2]),
        ("arm = \"left\"\n", [6, 5, 4, 3, 2, 1, 0, 7]),
        ("arm = \"left\"\nrotation = 1\n", [7, 6, 5, 4, 3, 2, 1, 0]),
    ] {
        let text = format!("files = \"{{person}}.npy\"\nrate = 200\n{lines}");
        let library = described(&text, &[("anna.npy", array(1, 700))]).unwrap();
        let expected = channel_of.map(|channel| count(1, 10, channel, &HOLD));
        assert_eq!(library.recordings[0].samples[10], expected, "{lines}");
    }
}

#[test]
fn the_examiner_judges_what_a_description_reads() {
    let text = "files = \"{person}.csv\"\nrate = 200\nchannels = [2,3,4,5,6,7,8,9]\ntime = 1\n";
    let at = |ms: usize| {
        table("", ",", 700, move |row| {
            (format!("{},", row * ms), String::new())
        })
    };
    assert_eq!(
        described(text, &[("anna.csv", at(5))])
            .unwrap()
            .recordings
            .len(),
        1
    );
    let error = described(text, &[("anna.csv", at(10))]).unwrap().skipped[0].line();
    assert!(
        error.contains("found 100 by column \"number 1\""),
        "{error}"
    );
    let leap = table("", ",", 1400, |row| {
        (format!("{},", 5 * row + 1000 * (row / 700)), String::new())
    });
    let library = described(text, &[("anna.csv", leap)]).unwrap();
    let names: Vec<_> = library
        .recordings
        .iter()
        .map(crate::Recording::full_name)
        .collect();
    assert_eq!(names, ["react-emg/anna/anna.1", "react-emg/anna/anna.2"]);
}

#[test]
fn what_is_named_otherwise_is_not_read_and_told() {
    let text = "files = \"{person}/{gesture}.npy\"\nrate = 200\nlabels = { open = [\"open\"] }\n";
    let files = [
        ("anna/open.npy", array(1, 700)),
        ("anna/fist.npy", array(2, 700)),
        ("readme.txt", b"hello".to_vec()),
    ];
    let library = described(text, &files).unwrap();
    assert_eq!(library.recordings.len(), 1);
    let skipped = library.skipped[0].line();
    assert!(
        skipped.contains("found \"fist\": add it to one of the lists"),
        "{skipped}"
    );
    assert_eq!(library.ignored.len(), 1);
    assert_eq!(library.ignored[0].reason, crate::SkipReason::Pattern);
    assert!(
        library
            .people
            .iter()
            .any(|told| told.contains("recordings.toml describes them: 1")),
        "{:?}",
        library.people
    );
}

#[test]
fn a_description_governs_its_folder_and_no_other() {
    let text = b"files = \"{person}.npy\"\nrate = 200\n".to_vec();
    let files = [
        ("lab/recordings.toml", text.clone()),
        ("lab/anna.npy", array(2, 700)),
        (
            "home/anna/1.csv",
            table(
                "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n",
                ",",
                700,
                |_| ("0,".to_owned(), String::new()),
            ),
        ),
    ];
    let folder = folder(&files);
    let subjects = |path: &Path| load(path, &LoadOptions::default()).unwrap().subjects();
    assert_eq!(
        subjects(folder.path()),
        ["react-emg/anna", "react-emg/lab/anna"]
    );
    assert_eq!(subjects(&folder.path().join("lab")), ["react-emg/anna"]);
    // A single file, and the description itself, are read alike; so is a description elsewhere.
    assert_eq!(
        subjects(&folder.path().join("lab/anna.npy")),
        ["react-emg/anna"]
    );
    assert_eq!(
        subjects(&folder.path().join("lab/recordings.toml")),
        ["react-emg/anna"]
    );
    let elsewhere = folder.path().join("home/mine.toml");
    std::fs::write(&elsewhere, [b"folder = \"../lab\"\n", &text[..]].concat()).unwrap();
    assert_eq!(subjects(&elsewhere), ["react-emg/anna"]);
}

#[test]
fn without_a_person_in_the_pattern_the_folder_is_the_person() {
    let text = "files = \"{any}/{session}/{trial}.npy\"\nrate = 200\n";
    let library = described(
        text,
        &[
            ("anna/day1/1.npy", array(1, 700)),
            ("ben/day1/1.npy", array(2, 700)),
        ],
    )
    .unwrap();
    let names: Vec<_> = library
        .recordings
        .iter()
        .map(crate::Recording::full_name)
        .collect();
    assert_eq!(names, ["react-emg/anna/day1/1", "react-emg/ben/day1/1"]);
}

#[test]
fn a_single_file_that_is_named_otherwise_is_read_as_without_a_description() {
    let folder = folder(&[
        (
            "recordings.toml",
            b"files = \"x/{person}.npy\"\nrate = 200\n".to_vec(),
        ),
        ("anna/1.npy", array(1, 700)),
    ]);
    let library = load(&folder.path().join("anna/1.npy"), &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["react-emg/anna"]);
    assert!(matches!(
        load(folder.path(), &LoadOptions::default()),
        Err(LoadError::NoRecordings { .. })
    ));
}

proptest::proptest! {
    /// No text makes the parser fail otherwise than by an error.
    #[test]
    fn any_text_is_a_description_or_an_error(lines in proptest::collection::vec(
        "(files|rate|labels|label|channels|time|scale|timing|header) = (\"\\{person\\}/\\{gesture\\}.csv\"|200|-1|true|\\[1, 2\\]|\\{ open = \\[1\\] \\}|\\PC{0,6})",
        0..6,
    )) {
        let _ = Description::parse(Path::new("recordings.toml"), &lines.join("\n"));
    }

    /// Whatever bytes a described file has, reading answers, and recordings are consistent.
    #[test]
    fn any_bytes_are_recordings_or_an_error(rows in proptest::collection::vec("[-0-9,;x. ]{0,24}", 0..40), changed: (usize, u8)) {
        let text = "files = \"{person}.csv\"\nrate = 200\nchannels = [1,2,3,4,5,6,7,8]\nlabel = 9\nlabels = { relax = [0], unknown = [\"*\"] }\n";
        let mut array = array(1, 60);
        let at = changed.0 % array.len();
        array[at] = changed.1;
        for bytes in [rows.join("\n").into_bytes(), array] {
            if let Ok(library) = described(text, &[("anna.csv", bytes)]) {
                for own in library.recordings {
                    proptest::prop_assert_eq!(own.samples.len(), own.labels.len());
                }
            }
        }
    }
}
