//! Descriptions that are read and refused, and the recordings that come of them. All inputs are made here.

mod refusals;

use std::path::Path;

use shared::intent::Intent;

use super::*;
use crate::labels::activity;
use crate::library::tests::folder;
use crate::recording::movement::{Movement, MovementKind};
use crate::{Library, LoadError, LoadOptions, Timing, load, npy, runs};

const R: Option<Intent> = Some(Intent::Relax);
const O: Option<Intent> = Some(Intent::Open);
const C: Option<Intent> = Some(Intent::Close);

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
        ("own/anna/anna", 600)
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
    let mut unknown = files(700);
    unknown[1].1[0] = b'7';
    let error = described(text, &unknown).unwrap().skipped[0].line();
    assert!(
        error.contains("1_ann.txt, line 1") && error.contains("found \"7\""),
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
    assert_eq!(library.subjects(), ["own/anna", "own/ben"]);
    let first = &library.recordings[0];
    assert_eq!(
        (first.full_name().as_str(), first.timing),
        ("own/anna/fist_1", Timing::Cues)
    );
    assert_eq!(first.labels, vec![C; 1000]);
    assert_eq!(library.recordings[1].labels, vec![R; 700]);
    let library = described(&text("timing = \"from-activity\""), &files).unwrap();
    let first = &library.recordings[0];
    let motion = crate::labels::motion::Motion::Intent(Intent::Close);
    let found = activity::label(&first.samples, motion).unwrap();
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
    let untimed = &text.replace("time = 1\n", "");
    let time = |period, row: usize| match period {
        "5 ms" => 5 * row,
        "10 ms" => 10 * row,
        _ => 10 * row + row * row / 140,
    };
    // A column that rises evenly is a clock; one that does not if the description says so.
    for (text, period, refused) in [
        (text, "5 ms", ""),
        (text, "10 ms", "found 100 by column \"number 1\""),
        (untimed, "10 ms", "found 100 by column"),
        (text, "10 to 20 ms", "by column \"number 1\""),
        (untimed, "10 to 20 ms", ""),
    ] {
        let rows = table("", ",", 700, |row| {
            (format!("{},", time(period, row)), String::new())
        });
        let library = described(text, &[("anna.csv", rows)]).unwrap();
        let told = library.skipped.first().map(LoadError::line);
        assert_eq!(told.is_some(), !refused.is_empty(), "{told:?}");
        assert!(told.unwrap_or_default().contains(refused), "{refused}");
    }
    let leap = table("", ",", 1400, |row| {
        (format!("{},", 5 * row + 1000 * (row / 700)), String::new())
    });
    let library = described(text, &[("anna.csv", leap)]).unwrap();
    let names: Vec<_> = library
        .recordings
        .iter()
        .map(crate::Recording::full_name)
        .collect();
    assert_eq!(names, ["own/anna/anna.1", "own/anna/anna.2"]);
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
    assert_eq!(subjects(folder.path()), ["own/anna", "own/lab/anna"]);
    assert_eq!(subjects(&folder.path().join("lab")), ["own/anna"]);
    // A single file, and the description itself, are read alike; so is a description elsewhere.
    assert_eq!(subjects(&folder.path().join("lab/anna.npy")), ["own/anna"]);
    assert_eq!(
        subjects(&folder.path().join("lab/recordings.toml")),
        ["own/anna"]
    );
    let elsewhere = folder.path().join("home/mine.toml");
    std::fs::write(&elsewhere, [b"folder = \"../lab\"\n", &text[..]].concat()).unwrap();
    assert_eq!(subjects(&elsewhere), ["own/anna"]);
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
    assert_eq!(names, ["own/anna/day1/1", "own/ben/day1/1"]);
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
    assert_eq!(library.subjects(), ["own/anna"]);
    assert!(matches!(
        load(folder.path(), &LoadOptions::default()),
        Err(LoadError::NoRecordings { .. })
    ));
}
