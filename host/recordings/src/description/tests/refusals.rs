//! Refusals, and their words.

use super::{array, described, table};
use crate::fixture::cells;
use crate::readers::open::SkipReason;
use crate::{LoadError, npy};

/// Line of the fault, words of the refusal, and lines of the description.
const UNUSABLE: &str = r#"3 | unknown field `foo`, expected one of `folder`, `files` | FILES ; rate = 200 ; foo = 1
1 | missing field `files` | rate = 200
1 | missing field `rate` | FILES
2 | expected 200 rows a second, found 100 | FILES ; rate = 100
2 | invalid type | FILES ; rate = "fast"
3 | counts of one unit | FILES ; rate = 200 ; scale = 0
3 | found -128 | FILES ; rate = 200 ; scale = -128
3 | found inf | FILES ; rate = 200 ; scale = inf
3 | found NaN | FILES ; rate = 200 ; scale = nan
3 | counts of one unit | FILES ; rate = 200 ; scale = 1e-320
3 | counts of one unit | FILES ; rate = 200 ; scale = 1e300
2 | found NaN | FILES ; rate = nan
3 | from 1 on, found -922 | FILES ; rate = 200 ; time = -922
3 | from 1 on, found inf | FILES ; rate = 200 ; time = inf
4 | found NaN | FILES ; rate = 200 ; label = 9 ; labels = { open = [nan] }
3 | EMG mode 2 | FILES ; rate = 200 ; rectified = true
3 | expected `right` or `left` | FILES ; rate = 200 ; arm = "middle"
3 | 0 to 7 places, found 8 | FILES ; rate = 200 ; rotation = 8
3 | found "|" | FILES ; rate = 200 ; separator = "|"
3 | found 3 columns | FILES ; rate = 200 ; channels = [1, 2, 3]
3 | one of them twice | FILES ; rate = 200 ; channels = [1, 2, 3, 4, 5, 6, 7, 7]
3 | names and numbers | FILES ; rate = 200 ; channels = ["a", 2, 3, 4, 5, 6, 7, 8]
3 | from 1 on, found 0 | FILES ; rate = 200 ; channels = [0, 1, 2, 3, 4, 5, 6, 7]
3 | `cues`, `muscle`, `from-activity` | FILES ; rate = 200 ; timing = "late"
3 | 0 to 2000 ms, found -5 | FILES ; rate = 200 ; cue_lag_ms = -5
3 | found "fist" | FILES ; rate = 200 ; labels = { fist = [1] }
1 | found {peron} | files = "{peron}.csv" ; rate = 200
1 | below the folder | files = "" ; rate = 200
1 | below the folder | files = "/data/{person}.csv" ; rate = 200
1 | below the folder | files = "../{person}.csv" ; rate = 200
1 | below the folder | files = '{person}\{trial}.csv' ; rate = 200
1 | closing brace | files = "{person/{trial}.csv" ; rate = 200
1 | closing brace | files = "person}.csv" ; rate = 200
1 | {person} once | files = "{person}/{person}_{trial}.csv" ; rate = 200
1 | between two fields | files = "{person}{trial}.csv" ; rate = 200
1 | recordings.toml | files = [
3 | found "1" twice | FILES ; rate = 200 ; labels = { open = [1], close = ["1.0"] }
3 | found "none" | FILES ; rate = 200 ; labels = { none = [1] }
3 | invalid type | FILES ; rate = 200 ; labels = { open = 1 }
- | needs `labels` | FILES ; rate = 200 ; label = "gt"
- | {gesture} in `files`, `label` or `label_files` | FILES ; rate = 200 ; labels = { open = [1] }
- | both | FILES ; rate = 200 ; label = 9 ; label_files = "{trial}.txt" ; labels = { open = [1] }
- | found {session} | FILES ; rate = 200 ; label_files = "{session}.txt" ; labels = { open = [1] }
- | needs {gesture} in `files` | FILES ; rate = 200 ; timing = "from-activity"
- | needs timing = "cues" | FILES ; rate = 200 ; timing = "muscle" ; cue_lag_ms = 100
- | needs `channels` | FILES ; rate = 200 ; separator = ";"
- | columns by number | FILES ; rate = 200 ; header = false ; channels = [1,2,3,4,5,6,7,8] ; time = "t"
- | found none at | FILES ; rate = 200 ; folder = "nowhere""#;

#[test]
fn a_description_that_cannot_be_used_names_file_line_and_field() {
    for [line, words, text] in cells(UNUSABLE) {
        let text = text.replace("FILES", "files = \"{person}/{trial}.csv\"");
        let text = text.replace(" ; ", "\n") + "\n";
        let error = described(&text, &[]).unwrap_err();
        let LoadError::Description { line: found, .. } = &error else {
            panic!("{text}: {error}");
        };
        assert_eq!(*found, line.parse().ok(), "{text}: {error}");
        let error = error.to_string();
        let is_told = error.contains(words) && error.contains("recordings.toml");
        assert!(is_told, "{text}: {error}");
    }
}

#[test]
fn faults_of_a_file_name_line_and_column() {
    let head = "files = \"{person}.csv\"\nrate = 200\n";
    let plain = &format!("{head}channels = [1, 2, 3, 4, 5, 6, 7, 8]\n");
    let scaled = &format!("scale = 1000\n{plain}");
    let ninth = |label: &str| format!("{plain}label = {label}\nlabels = {{ relax = [0] }}\n");
    let labelled = &ninth("9");
    let good = || table(150, ",", |_, counts| format!("{counts},0"));
    let with = |line: &str| [&good(), line.as_bytes(), b"\n"].concat();
    let array = |columns: usize| npy::encode("|i1", &[50, columns], &vec![1; 50 * columns]);
    let told = |text: &str, bytes, words: &str| {
        let library = described(text, &[("anna.csv", bytes)]);
        let error = library.map_or_else(|error| error.line(), |own| own.skipped[0].line());
        let is_told = error.contains(words) && error.contains("anna.csv");
        assert!(is_told, "{text}: {error}");
    };
    for (row, words) in [
        ("1,2,3,4,5,6,7,8,7", "a label that is listed"),
        ("1,2,3", "9 values"),
        ("1,2,3,x,5,6,7,8,0", "a number in field 4, found \"x\""),
        ("1,2,300,4,5,6,7,8,0", "a count of the armband in field 3"),
    ] {
        told(labelled, with(row), &format!("line 151: expected {words}"));
    }
    let tenth = "number 10 of the description, found 9 columns";
    for (text, bytes, words) in [
        (&ninth("10"), good(), tenth),
        (&ninth("\"gt\""), good(), "column \"gt\""),
        (scaled, good(), "whole multiples of 1000"),
        (plain, Vec::new(), "expected one row per sample"),
        (plain, b"PK\x03\x04".to_vec(), "as a description has them"),
        (plain, array(7), "a description that numbers eight"),
        (&head.to_owned(), array(9), "(50, 9)"),
    ] {
        told(text, bytes, words);
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
    let words = "found \"fist\": add it to one of the lists";
    assert!(skipped.contains(words), "{skipped}");
    let ignored: Vec<_> = library.ignored.iter().map(|own| own.reason).collect();
    assert_eq!(ignored, [SkipReason::Pattern]);
    let told = library.people.concat();
    let words = "recordings.toml describes them: 1 recordings of 1 people: anna";
    assert!(told.contains(words), "{told}");
}
