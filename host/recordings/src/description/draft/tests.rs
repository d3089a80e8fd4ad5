use super::*;
use crate::fixture::{HEADER, cells, folder};

/// Text of the draft of a folder with these files.
fn written(files: &[(&str, String)]) -> Result<String, LoadError> {
    let folder = folder(files);
    let (path, text) = describe(folder.path(), None)?;
    assert_eq!(std::fs::read_to_string(path).unwrap(), text);
    Ok(text)
}

/// Lines of a draft without comments.
fn fields(text: &str) -> Vec<&str> {
    let is_field = |line: &&str| !line.is_empty() && !line.starts_with('#');
    text.lines().filter(is_field).collect()
}

/// A table of so many channels, with the text `more` of each row behind them.
fn table(head: &str, channels: usize, more: impl Fn(usize) -> String) -> String {
    let value = |row: usize, channel: usize| (row * 37 + channel * 11) as i32 % 29 - 14;
    let rows = (0..400).map(|row| {
        let values: Vec<String> = (0..channels).map(|c| value(row, c).to_string()).collect();
        values.join(",") + &more(row) + "\n"
    });
    head.to_owned() + &rows.collect::<String>()
}

fn plain() -> String {
    table("", 8, |_| String::new())
}

#[test]
fn names_numbers_and_words_tell_the_columns() {
    let words = ["rest", "fist", "snap"];
    let text = table("a,b,c,d,e,f,g,h,gyr,pose\n", 9, |row| {
        format!(",{}", words[row / 150])
    });
    let text = written(&[("anna/1.csv", text.clone()), ("ben/1.csv", text)]).unwrap();
    let expected = [
        r#"files = "{person}/1.csv""#,
        r#"separator = ",""#,
        "header = true",
        r#"channels = ["a", "b", "c", "d", "e", "f", "g", "h"]"#,
        r#"label = "pose""#,
        "rate = 200",
        r#"labels = { close = ["fist"], relax = ["rest"], unknown = ["snap"] }"#,
    ];
    assert_eq!(fields(&text), expected);
    assert!(text.contains("the first eight columns of num"), "{text}");
    // So are times, however late a row came, and with eight columns of numbers there is nothing to check.
    let late = |row: usize| format!(",{}", 5 * row + [0, 4, 1][row % 3]);
    let text = written(&[("1.csv", table("", 8, late))]).unwrap();
    assert!(fields(&text).contains(&"time = 9"), "{text}");
    assert!(!text.contains("the first eight"), "{text}");
    // Columns with names that are known are found by them.
    let known = HEADER.trim_start_matches("gt,").replace('\n', ",gt\n");
    let text = written(&[("1.csv", table(&known, 8, |row| format!(",{}", row / 200)))]).unwrap();
    let expected = [
        r#"files = "1.csv""#,
        r#"label = "gt""#,
        "rate = 200",
        "labels = { open = [1], relax = [0] }",
    ];
    assert_eq!(fields(&text), expected);
    // Without a name, the first eight columns of numbers are the channels, and a person says what the ninth is.
    let text = written(&[("1.csv", table("", 8, |row| format!(",{}", row / 200)))]).unwrap();
    let channels = "channels = [1, 2, 3, 4, 5, 6, 7, 8]";
    assert!(fields(&text).contains(&channels), "{text}");
    assert!(text.contains("\n# label = 9\n"), "{text}");
}

#[test]
fn what_is_the_same_in_all_paths_is_text_and_the_outermost_folder_is_the_person() {
    for [one, other, pattern] in cells(
        "p1/open_1.csv | p2/fist_2.csv | {person}/{any}.csv
        p1/m/x_a.CSV | p2/n/y_a.csv | {person}/{session}/{any}_a.csv
        all/a_1_emg.csv | all/a_02_emg.csv | all/a_{any}_emg.csv
        a_emg.csv | a_b_emg.csv | {any}.csv",
    ) {
        let text = written(&[(one, plain()), (other, plain())]).unwrap();
        let expected = format!("files = \"{pattern}\"");
        assert!(fields(&text).contains(&&*expected), "{text}");
        assert!(!text.contains("Cannot be read"), "{text}");
    }
}

#[test]
fn the_kind_of_most_files_is_described_and_the_others_are_told() {
    let text = written(&[
        ("a_1.csv", plain()),
        ("a_2.csv", plain()),
        ("deeper/a_3.csv", plain()),
        ("b/x.csv", table("a,b,c,d,e,f,g,h\n", 8, |_| String::new())),
        ("notes.txt", "hello\n".into()),
    ])
    .unwrap();
    for words in [
        "files = \"a_{any}.csv\"",
        "Named otherwise, and not read: 1, such as deeper/a_3.csv",
        "With other columns, and not read: 1, such as b/x.csv",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    // One that is not as deep comes first, and so does one with a column more.
    let label = table("", 8, |at| [",rest", ",fist"][at / 200].to_owned());
    let text = written(&[
        ("Test.csv", plain()),
        ("aa/0.csv", label),
        ("anna/1.csv", plain()),
        ("berta/1.csv", plain()),
    ])
    .unwrap();
    assert!(text.contains("files = \"{person}/1.csv\""), "{text}");
    assert!(!text.contains("Cannot be read"), "{text}");
}

#[test]
fn what_no_description_can_read_is_told() {
    let text = written(&[("1.csv", plain() + "1,2,3\n" + &plain())]).unwrap();
    let words = "Cannot be read so: 1 files; the first: ";
    assert!(text.contains(words), "{text}");
    let filtered = (0..2400).map(|at| {
        let end = if at % 8 == 7 { "\n" } else { "," };
        (f64::from(at) * 0.731 + 0.01).sin().to_string() + end
    });
    let text = written(&[("1.csv", filtered.collect())]).unwrap();
    assert!(text.contains("# scale = 128"), "{text}");
}

#[test]
fn a_folder_without_samples_says_so() {
    let empty = "emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7\n".to_owned();
    for files in [
        vec![],
        vec![("notes.txt", "hello\n".to_owned())],
        vec![("a.csv", empty)],
    ] {
        let error = written(&files).unwrap_err().to_string();
        assert!(error.contains("no recordings in"), "{error}");
    }
}

#[test]
fn an_existing_description_is_never_replaced() {
    let folder = folder(&[("a.csv", plain())]);
    let refusal = |path: &Path| describe(path, None).unwrap_err().to_string();
    describe(folder.path(), None).unwrap();
    for (below, words) in [
        ("", "recordings.toml: there is one already: correct it"),
        ("a.csv", "expected a folder"),
    ] {
        let told = refusal(&folder.path().join(below));
        assert!(told.contains(words), "{told}");
    }
}
