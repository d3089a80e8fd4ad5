use proptest::prelude::*;

use super::*;
use crate::description::Problem;

/// Lines that are written for a folder with these files, without comments, and the whole text.
fn written(files: &[(&str, String)]) -> Result<(Vec<String>, String), SurveyError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let (path, text) = describe(folder.path(), None)?;
    assert_eq!(std::fs::read_to_string(path).unwrap(), text);
    let lines = text
        .lines()
        .map(|line| line.split("    #").next().unwrap_or_default());
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    Ok((lines.map(str::to_owned).collect(), text))
}

/// Value of a channel that changes from row to row.
fn count(row: usize, channel: usize) -> i32 {
    (row * 37 + channel * 11) as i32 % 29 - 14
}

fn table(head: &str, rows: usize, row: impl Fn(usize) -> String) -> String {
    let rows = (0..rows).map(|at| row(at) + "\n");
    head.to_owned() + &rows.collect::<String>()
}

fn counts(row: usize, channels: usize, scale: impl Fn(i32) -> String) -> String {
    let values: Vec<String> = (0..channels).map(|c| scale(count(row, c))).collect();
    values.join(",")
}

fn has(lines: &[String], line: &str) -> bool {
    lines.iter().any(|own| own == line)
}

#[test]
fn columns_without_names_are_told_by_their_values() {
    let text = table("", 400, |at| {
        format!(
            "{},{},{}",
            at * 5,
            counts(at, 8, |v| v.to_string()),
            at / 100
        )
    });
    let (lines, _) = written(&[("anna/1.csv", text.clone()), ("ben/1.csv", text)]).unwrap();
    for line in [
        r#"files = "{person}/1.csv""#,
        "header = false",
        "channels = [2, 3, 4, 5, 6, 7, 8, 9]",
        "time = 1",
        "label = 10",
        "rate = 200",
        "rectified = false",
        "labels = { unknown = [0, 1, 2, 3] }",
    ] {
        assert!(has(&lines, line), "{line}: {lines:?}");
    }
}

/// Text of a row.
type Row<'r> = &'r dyn Fn(usize) -> String;

#[test]
fn a_column_that_counts_is_a_clock_wherever_it_stands() {
    let row = |at: usize| counts(at, 8, |v| v.to_string());
    let first = "channels = [2, 3, 4, 5, 6, 7, 8, 9]";
    let last = "channels = [1, 2, 3, 4, 5, 6, 7, 8]";
    let kinds: [(Row<'_>, &str, &str); 7] = [
        (
            &|at| format!("{},{},{}", at % 100, row(at), at / 150),
            first,
            "time = 1",
        ),
        (
            &|at| format!("{},{},{}", at % 100 + 1, row(at), at / 40 % 4),
            first,
            "time = 1",
        ),
        (&|at| format!("{},{}", at % 256, row(at)), first, "time = 1"),
        (&|at| format!("{},{}", at + 1, row(at)), first, "time = 1"),
        (&|at| format!("{},{}", row(at), at % 50), last, "time = 9"),
        (
            &|at| format!("{},{},{}", row(at), at / 150, at % 200),
            last,
            "time = 10",
        ),
        (
            &|at| format!("10:00:{:06.3},{}", at as f64 * 0.005, row(at)),
            first,
            "time = 1",
        ),
    ];
    for (row, channels, time) in kinds {
        let text = table("", 600, row);
        let (lines, text) = written(&[("anna/1.csv", text.clone()), ("ben/1.csv", text)]).unwrap();
        for line in [channels, time, "rate = 200"] {
            assert!(has(&lines, line), "{line}: {text}");
        }
        assert!(!text.contains("look like channels"), "{text}");
    }
}

#[test]
fn words_of_a_column_are_its_labels_and_more_columns_are_told() {
    let words = ["rest", "fist", "snap"];
    let text = table("a\tb\tc\td\te\tf\tg\th\tgyr\tpose\n", 600, |at| {
        format!(
            "{}\t{}",
            counts(at, 9, |v| v.to_string()).replace(',', "\t"),
            words[at / 200]
        )
    });
    let (lines, text) = written(&[("1.txt", text)]).unwrap();
    assert!(has(&lines, r#"separator = "\t""#), "{lines:?}");
    assert!(
        has(
            &lines,
            r#"channels = ["a", "b", "c", "d", "e", "f", "g", "h"]"#
        ),
        "{lines:?}"
    );
    let labels = r#"labels = { relax = ["rest"], close = ["fist"], unknown = ["snap"] }"#;
    assert!(has(&lines, labels), "{lines:?}");
    assert!(text.contains("9 columns look like channels"), "{text}");
}

#[test]
fn labels_are_in_a_column_or_in_a_file_beside_but_not_in_both() {
    let table = |end: &dyn Fn(usize) -> String| {
        table("", 400, |at| counts(at, 8, |v| v.to_string()) + &end(at))
    };
    let words: String = (0..400).map(|at| format!("{}\n", at / 100)).collect();
    let files = |samples: String| {
        [
            ("anna/1_emg.csv", samples),
            ("anna/1_ann.txt", words.clone()),
        ]
    };
    let (lines, _) = written(&files(table(&|_| String::new()))).unwrap();
    assert!(
        has(&lines, r#"label_files = "anna/1_ann.txt""#),
        "{lines:?}"
    );
    let column = files(table(&|at| format!(",{}", at / 200)));
    let (lines, _) = written(&column).unwrap();
    assert!(has(&lines, "label = 9"), "{lines:?}");
    assert!(
        !lines.iter().any(|line| line.starts_with("label_files")),
        "{lines:?}"
    );
}

#[test]
fn what_is_refused_is_written_as_it_is_seen() {
    let rectified = table("", 300, |at| counts(at, 8, |v| v.abs().to_string()));
    let (lines, text) = written(&[("1.csv", rectified)]).unwrap();
    assert!(
        has(&lines, "rectified = true") && text.contains("it is refused"),
        "{text}"
    );
    let slow = table("t,a,b,c,d,e,f,g,h\n", 300, |at| {
        format!("{},{}", at * 20, counts(at, 8, |v| v.to_string()))
    });
    let (lines, _) = written(&[("1.csv", slow)]).unwrap();
    assert!(has(&lines, "rate = 50"), "{lines:?}");
    let filtered = table("", 300, |at| {
        counts(at, 8, |v| (f64::from(v) * 0.731 + 0.01).sin().to_string())
    });
    let (lines, text) = written(&[("1.csv", filtered)]).unwrap();
    assert!(
        has(&lines, "scale = 1") && text.contains("no counts of a known unit"),
        "{text}"
    );
}

#[test]
fn bytes_without_a_sign_are_told_as_the_examiner_tells_them() {
    let offset = |v: i32| (v + 128).to_string();
    let unsigned = |v: i32| (v & 255).to_string();
    let kinds: [(&dyn Fn(i32) -> String, &str); 2] = [
        (
            &offset,
            "bytes with 128 added: subtract 128 from each value",
        ),
        (
            &unsigned,
            "bytes without a sign: subtract 256 from each value above 127",
        ),
    ];
    for (kind, words) in kinds {
        for head in ["", "a,b,c,d,e,f,g,h\n"] {
            let text = table(head, 300, |at| counts(at, 8, kind));
            let (lines, text) = written(&[("1.csv", text)]).unwrap();
            assert!(text.contains(words), "{text}");
            assert!(has(&lines, "rectified = false"), "{text}");
        }
    }
}

#[test]
fn the_layout_of_most_files_is_described_and_the_others_are_told() {
    let plain = || table("", 300, |at| counts(at, 8, |v| v.to_string()));
    let volts = table("", 300, |at| {
        counts(at, 9, |v| format!("{:.5}", f64::from(v) * 1e-5))
    });
    let (lines, text) = written(&[
        ("a_1.csv", plain()),
        ("a_2.csv", plain()),
        ("b/x.csv", volts),
        ("notes.txt", "hello\n".into()),
    ])
    .unwrap();
    assert!(has(&lines, r#"files = "a_{trial}.csv""#), "{lines:?}");
    assert!(
        text.contains("With other columns, and not described here: 1 files such as b/x.csv"),
        "{text}"
    );
}

#[test]
fn endings_in_capitals_are_described_with_the_small_ones() {
    let plain = || table("", 300, |at| counts(at, 8, |v| v.to_string()));
    let words = || "1\n".repeat(300);
    let (lines, text) = written(&[
        ("anna/1_emg.CSV", plain()),
        ("anna/1_ann.TXT", words()),
        ("ben/1_emg.csv", plain()),
        ("ben/1_ann.txt", words()),
    ])
    .unwrap();
    assert!(has(&lines, r#"files = "{person}/1_emg.csv""#), "{text}");
    assert!(
        has(&lines, r#"label_files = "{person}/1_ann.txt""#),
        "{text}"
    );
    assert!(!text.contains("Cannot be read"), "{text}");
}

#[test]
fn a_folder_without_samples_says_what_it_has() {
    for files in [
        vec![],
        vec![("notes.txt", "hello\n".to_owned())],
        vec![(
            "a.csv",
            "emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7\n".to_owned(),
        )],
    ] {
        let error = written(&files).unwrap_err().to_string();
        assert!(error.contains("no recordings in"), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn a_dangling_link_stops_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let text = table("", 300, |at| counts(at, 8, |v| v.to_string()));
    std::fs::write(folder.path().join("a.csv"), text).unwrap();
    std::os::unix::fs::symlink("/nowhere/b.csv", folder.path().join("b.csv")).unwrap();
    let (_, text) = describe(folder.path(), None).unwrap();
    assert!(text.contains("files = \"a.csv\""), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever the files hold, a description is written that is one, but for what it says is refused, or an error says why
    /// not.
    #[test]
    fn any_files_are_described_or_an_error(
        files in prop::collection::vec(("[a-c]{1}(/[a-c1-3_.-]{1,6}){0,2}", prop::collection::vec("(-?[0-9.]{1,4}[,;\t ]){7,9}[0-9ax]{0,2}|\\PC{0,9}", 0..30)), 0..4),
    ) {
        let named: Vec<(String, String)> = files
            .into_iter()
            .enumerate()
            .map(|(at, (name, rows))| (format!("{at}{name}.csv"), rows.join("\n")))
            .collect();
        let files: Vec<(&str, String)> = named.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
        if let Ok((_, text)) = written(&files) {
            let read = Description::parse(Path::new("recordings.toml"), &text);
            let refused = |problem: &Problem| matches!(problem, Problem::Syntax(why) if why.contains("rows a second") || why.contains("their sign"));
            prop_assert!(read.as_ref().map_or_else(|error| refused(&error.problem), |_| true), "{:?}\n{}", read, text);
        }
    }
}
