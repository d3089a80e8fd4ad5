//! Refusals, and their words.

use std::path::Path;

use super::{array, described, table};
use crate::description::Description;
use crate::{LoadError, npy};

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
            .any(|told| told
                .contains("recordings.toml describes them: 1 recordings of 1 people: anna")),
        "{:?}",
        library.people
    );
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
