//! Descriptions that are read and refused, and the recordings that come of them. All inputs are made here.

mod refusals;

use std::path::Path;

use shared::intent::Intent;
use shared::units::Sample;

use super::*;
use crate::fixture::{C, O, R, emg, folder, joined, names};
use crate::labels::activity;
use crate::labels::motion::Motion;
use crate::recording::movement::{Movement, MovementKind};
use crate::{Library, LoadError, LoadOptions, Timing, load, runs};

fn described(text: &str, files: &[(&str, Vec<u8>)]) -> Result<Library, LoadError> {
    let folder = folder(files);
    std::fs::write(folder.path().join(FILE_NAME), text).unwrap();
    load(folder.path(), &LoadOptions::default())
}

fn array(person: u64, rows: usize) -> Vec<u8> {
    crate::fixture::array(&emg(rows, person))
}

/// A table of so many rows, each as `row` writes it with the counts and their separator.
fn table(rows: usize, separator: &str, row: impl Fn(usize, &str) -> String) -> Vec<u8> {
    let row = |at, own: &Sample| row(at, &joined(own, separator));
    crate::fixture::rows(&emg(rows, 1), row).into_bytes()
}

#[test]
fn channels_come_in_any_order_with_time_and_words() {
    let text = r#"files = "{person}.csv"
        rate = 200
        separator = ";"
        header = true
        channels = ["h", "g", "f", "e", "d", "c", "b", "a"]
        time = "when"
        label = "what"
        labels = { relax = ["zzz"], open = ["auf"], point = ["zeig"], unknown = [""] }
        scale = 128"#;
    let word = |row: usize| ["zzz", "auf", "zeig", ""][row / 150 % 4];
    let rows = crate::fixture::rows(&emg(600, 1), |row, own| {
        let counts = own.map(|count| f64::from(count) / 128.0);
        let counts = joined(&counts, ";").replace('.', ",");
        format!("{};{counts};{}", 5 * row, word(row))
    });
    let rows = "# ein Kommentar\nwhen;a;b;c;d;e;f;g;h;what\n".to_owned() + &rows;
    let library = described(text, &[("anna.csv", rows.into_bytes())]).unwrap();
    let own = &library.recordings[0];
    assert_eq!(names(&library), ["own/anna/anna"]);
    let mut expected = emg(301, 1)[300];
    expected.reverse();
    assert_eq!((own.samples.len(), own.samples[300]), (600, expected));
    let labels = runs(&own.labels).into_iter();
    let labels = labels.map(|run| (run.label, run.samples()));
    assert!(labels.eq([(R, 150), (O, 150), (None, 300)]));
    let point = Movement::new(MovementKind::Point, 300..450);
    assert_eq!(own.other_movement, [point]);
}

#[test]
fn labels_of_a_file_beside_are_read_sample_by_sample() {
    let text = "files = \"{person}/{session}_emg.npy\"\nlabel_files = \"{person}/{session}_ann.txt\"\nrate = 200\n\
                labels = { relax = [0], close = [\"fist\"] }\n";
    let files = |rows: usize| {
        let words = "0\n".repeat(300) + &"fist\n".repeat(rows - 300);
        [
            ("anna/1_emg.npy", array(1, 700)),
            ("anna/1_ann.txt", words.into_bytes()),
        ]
    };
    let library = described(text, &files(700)).unwrap();
    let labels = runs(&library.recordings[0].labels).into_iter();
    assert!(labels.map(|run| run.label).eq([R, C]));
    assert!(library.ignored.is_empty(), "{:?}", library.ignored);
    let mut unknown = files(700);
    unknown[1].1[0] = b'7';
    for (files, words) in [
        (&files(699)[..], ["1_ann.txt", "699 labels for 700 samples"]),
        (&unknown, ["1_ann.txt, line 1", "found \"7\""]),
        (&files(700)[..1], ["1_emg.npy", "1_ann.txt beside it"]),
    ] {
        let error = described(text, files).unwrap().skipped[0].line();
        assert!(words.iter().all(|own| error.contains(own)), "{error}");
    }
}

#[test]
fn a_file_of_one_gesture_is_labelled_by_its_name_or_by_the_muscle() {
    let files = [
        ("anna/fist_1.npy", array(1, 1000)),
        ("anna/rest_1.npy", array(2, 700)),
        ("ben/fist_1.npy", array(3, 1000)),
    ];
    let read = |timing: &str| {
        let text = format!(
            "files = \"{{person}}/{{gesture}}_{{trial}}.npy\"\nrate = 200\n{timing}\nlabels = {{ close = [\"fist\"], relax = [\"rest\"] }}\n"
        );
        described(&text, &files).unwrap()
    };
    let library = read("");
    assert_eq!(library.subjects(), ["own/anna", "own/ben"]);
    assert_eq!(names(&library)[0], "own/anna/fist_1");
    let [first, rest, _] = &library.recordings[..] else {
        panic!("{library:?}");
    };
    assert_eq!(
        (&first.labels[..], first.timing),
        (&[C; 1000][..], Timing::Cues)
    );
    assert_eq!(rest.labels, [R; 700]);
    let library = read("timing = \"from-activity\"");
    let first = &library.recordings[0];
    let found = activity::label(&first.samples, Motion::Intent(Intent::Close)).unwrap();
    assert_eq!(
        (&first.labels, first.timing),
        (&found.labels, Timing::Muscle)
    );
    assert_eq!([100, 600, 900].map(|at| first.labels[at]), [R, C, R]);
    assert_eq!(library.recordings[1].labels, [R; 700]);
}

#[test]
fn a_stated_lag_moves_the_labels_for_good() {
    let text = "files = \"{person}.csv\"\nrate = 200\nchannels = [1,2,3,4,5,6,7,8]\nlabel = 9\ncue_lag_ms = 250\n\
                labels = { relax = [0], other = [2] }\n";
    let label = |row: usize| 2 * usize::from((200..500).contains(&row));
    let rows = table(800, " ", |row, counts| format!("{counts} {}", label(row)));
    let library = described(text, &[("anna.csv", rows)]).unwrap();
    let own = &library.recordings[0];
    assert_eq!(own.timing, Timing::Muscle);
    let other = Movement::new(MovementKind::Other, 250..550);
    assert_eq!(own.other_movement, [other]);
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
        let expected = channel_of.map(|channel: usize| emg(11, 1)[10][channel]);
        assert_eq!(library.recordings[0].samples[10], expected, "{lines}");
    }
}

#[test]
fn the_examiner_judges_what_a_description_reads() {
    let text = "files = \"{person}.csv\"\nrate = 200\nchannels = [2,3,4,5,6,7,8,9]\ntime = 1\n";
    let untimed: &str = &text.replace("time = 1\n", "");
    let read = |text: &str, rows, time: &dyn Fn(usize) -> usize| {
        let rows = table(rows, ",", |row, counts| format!("{},{counts}", time(row)));
        described(text, &[("anna.csv", rows)]).unwrap()
    };
    let slower = |row: usize| 10 * row + row * row / 140;
    // A column that rises evenly is a clock; one that does not if the description says so.
    let cases: [(_, &dyn Fn(usize) -> usize, _); 5] = [
        (text, &|row| 5 * row, ""),
        (text, &|row| 10 * row, "found 100 by column \"number 1\""),
        (untimed, &|row| 10 * row, "found 100 by column"),
        (text, &slower, "by column \"number 1\""),
        (untimed, &slower, ""),
    ];
    for (text, time, refused) in cases {
        let skipped = read(text, 700, time).skipped;
        let told = skipped.first().map_or(String::new(), |own| own.line());
        assert_eq!(told.is_empty(), refused.is_empty(), "{told}");
        assert!(told.contains(refused), "{refused}: {told}");
    }
    let leap = read(text, 1400, &|row| 5 * row + 1000 * (row / 700));
    assert_eq!(names(&leap), ["own/anna/anna.1", "own/anna/anna.2"]);
}

#[test]
fn a_description_governs_its_folder_and_no_other() {
    let text = b"files = \"{person}.npy\"\nrate = 200\n".to_vec();
    let head = crate::fixture::HEADER.as_bytes();
    let rows = table(700, ",", |_, counts| format!("0,{counts}"));
    let elsewhere = [b"folder = \"../lab\"\n", &text[..]].concat();
    let folder = folder(&[
        ("lab/recordings.toml", text),
        ("lab/anna.npy", array(2, 700)),
        ("home/anna/1.csv", [head, &rows].concat()),
        ("home/mine.toml", elsewhere),
    ]);
    // A single file, and the description itself, are read alike; so is a description elsewhere.
    for (path, people) in [
        ("", &["own/anna", "own/lab/anna"][..]),
        ("lab", &["own/anna"]),
        ("lab/anna.npy", &["own/anna"]),
        ("lab/recordings.toml", &["own/anna"]),
        ("home/mine.toml", &["own/anna"]),
    ] {
        let library = load(&folder.path().join(path), &LoadOptions::default());
        assert_eq!(library.unwrap().subjects(), people, "{path}");
    }
}

#[test]
fn without_a_person_in_the_pattern_the_folder_is_the_person() {
    let text = "files = \"{any}/{session}/{trial}.npy\"\nrate = 200\n";
    let files = ["anna/day1/1.npy", "ben/day1/1.npy"];
    let files = [(files[0], array(1, 700)), (files[1], array(2, 700))];
    let library = described(text, &files).unwrap();
    assert_eq!(names(&library), ["own/anna/day1/1", "own/ben/day1/1"]);
}

#[test]
fn a_single_file_that_is_named_otherwise_is_read_as_without_a_description() {
    let text = b"files = \"x/{person}.npy\"\nrate = 200\n".to_vec();
    let folder = folder(&[(FILE_NAME, text), ("anna/1.npy", array(1, 700))]);
    let read = |path: &Path| load(path, &LoadOptions::default());
    let library = read(&folder.path().join("anna/1.npy")).unwrap();
    assert_eq!(library.subjects(), ["own/anna"]);
    let all = read(folder.path()).unwrap_err();
    assert!(matches!(all, LoadError::NoRecordings { .. }), "{all}");
}
