use super::*;
use crate::fixture::{HEADER, array, cells, counts, emg, folder, joined, names, read, rows};

#[test]
fn a_damaged_file_is_listed_or_stops_a_strict_load() {
    let good = "1,2,3,4,5,6,7,8,0\n".repeat(30);
    let bad = ("12345-1/7.txt", format!("{good}1,2\n"));
    let words = "7.txt, line 31: expected 9";
    let both = folder(&[("12345-1/0.txt", good), bad.clone()]);
    let library = load(both.path(), &LoadOptions::default()).unwrap();
    assert_eq!((library.recordings.len(), library.skipped.len()), (1, 1));
    let strict = LoadOptions {
        strict: true,
        ..LoadOptions::default()
    };
    let strict = load(both.path(), &strict).unwrap_err().to_string();
    let doubt = &library.doubts()[0];
    for told in [&strict, doubt] {
        assert!(told.contains(words), "{told}");
    }
    assert!(doubt.starts_with("files left out: 1 "), "{doubt}");
    let error = read(&[bad]).not_empty(both.path()).unwrap_err().to_string();
    assert!(error.contains("1 files are left out"), "{error}");
}

#[test]
fn rows_of_no_known_set_are_no_people_and_those_of_a_single_file_are_read() {
    let row = [1, 2, 3, 4, 5, 6, 7, 8];
    let array = array(&[row; 100]);
    let texts = [",", ";", "\t", " "].map(|separator| {
        let row = row.map(|count| count.to_string()).join(separator) + "\n";
        ("a/1.csv", row.repeat(100).into_bytes())
    });
    for (name, rows) in texts.into_iter().chain([("a/1.npy", array)]) {
        let folder = folder(&[(name, &rows), ("b/2.txt", &rows)]);
        let refused = |path: &Path| load(path, &LoadOptions::default()).unwrap_err();
        let error = refused(folder.path());
        assert!(matches!(error, LoadError::NoRecordings { .. }), "{error}");
        let missing = refused(&folder.path().join("nowhere"));
        assert!(matches!(missing, LoadError::Io { .. }), "{missing}");
        let one = load(&folder.path().join(name), &LoadOptions::default()).unwrap();
        assert_eq!(one.subjects(), ["own/a"]);
        assert_eq!(one.recordings[0].samples[99], [1, 2, 3, 4, 5, 6, 7, 8]);
        assert!(!one.recordings[0].has_labels());
    }
}

/// Table of a person, rest and a fist in turn.
fn own(person: u64) -> String {
    counts(&emg(1000, person))
}

#[test]
fn one_person_is_the_same_whichever_folder_is_asked_for() {
    let folder = folder(&[
        ("study/anna/monday/1.csv", own(1)),
        ("study/anna/2026-11-25/1.csv", own(2)),
        ("study/bob/session_1/1.csv", own(3)),
    ]);
    for (below, people) in [
        ("", &["own/anna", "own/bob"][..]),
        ("study/anna", &["own/anna"]),
        ("study/anna/monday", &["own/anna"]),
        ("study/anna/monday/1.csv", &["own/anna"]),
    ] {
        let library = load(&folder.path().join(below), &LoadOptions::default()).unwrap();
        assert_eq!(library.subjects(), people, "{below}");
    }
}

#[test]
fn an_own_folder_called_left_is_told_and_read_as_it_is() {
    let library = read(&[
        ("anna/left/1.csv", own(1)),
        ("anna/links/1.csv", own(2)),
        ("anna/1.csv", own(3)),
    ]);
    let told = |own: &Recording| own.notes.iter().any(|note| note.contains("left arm"));
    let told: Vec<bool> = library.recordings.iter().map(told).collect();
    assert_eq!(told, [false, true, true]);
    assert_eq!(library.recordings[1].samples, emg(1000, 1));
}

#[test]
fn a_refusal_says_what_was_found_and_what_was_expected() {
    let nine = own(1).lines().skip(1).collect::<Vec<_>>().join("\n");
    let latin = [b"gt,emg_0 \xb5V\n".as_slice(), own(1).as_bytes()].concat();
    let array =
        |columns: usize| crate::npy::encode("|i1", &[700, columns], &vec![3; 700 * columns]);
    let mut edf = [&b"0       "[..], &[b' '; 2296]].concat();
    edf[184..188].copy_from_slice(b"2304");
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n";
    for (name, bytes, words) in [
        ("nine.csv", nine.as_bytes(), "9 columns|header"),
        ("latin.csv", &latin, "UTF-8"),
        ("notes.csv", b"Dear reader,\nno recording.\n", "text"),
        ("nine.npy", &array(9), "(700, 9)|eight|label"),
        ("wide.npy", &array(700), "(700, 700)|(n, 8)"),
        ("pointer.npy", pointer, "Git LFS|git lfs pull"),
        ("page.csv", b"<!DOCTYPE html>\n<html>a,b</html>\n", "HTML"),
        ("archive.csv", b"PK\x03\x04\x14\0\0\0", "zip"),
        ("model.dat", b"myointnt\x07", "model"),
        ("empty.csv", b"", "empty"),
        ("1.edf", &edf, "an EDF or BDF file: save its eight channels"),
        ("2.xdf", b"XDF:\x01\x04", "with the package `pyxdf`"),
    ] {
        let folder = folder(&[(name, bytes)]);
        let message = match load(&folder.path().join(name), &LoadOptions::default()) {
            Ok(library) => library.skipped[0].to_string(),
            Err(error) => error.to_string(),
        };
        for word in words.split('|') {
            assert!(message.contains(word), "{name}: {message}");
        }
        for other in ["12345-1/7.txt", "sub7/", "s3/s3_", "classe_"] {
            assert!(!message.contains(other), "{name}: {message}");
        }
    }
}

#[cfg(unix)]
#[test]
fn links_to_nothing_and_to_a_device_are_listed_and_stop_nothing() {
    let folder = folder(&[("s1/s1_a.csv", format!("{HEADER}0,1,2,3,4,5,6,7,8\n"))]);
    for (name, target) in [
        ("s1/s1_gone.csv", "nowhere.csv"),
        ("s1/s1_z.csv", "/dev/zero"),
    ] {
        std::os::unix::fs::symlink(target, folder.path().join(name)).unwrap();
    }
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(library.recordings.len(), 1);
    let skipped = library.skipped.iter().map(ToString::to_string);
    let skipped = skipped.collect::<Vec<_>>().join("\n");
    for name in ["s1_gone.csv", "s1_z.csv"] {
        assert!(skipped.contains(name), "{skipped}");
    }
}

#[test]
fn a_byte_order_mark_is_no_part_of_the_header_and_utf_16_is_refused_with_what_to_do() {
    let text = format!("\u{feff}{HEADER}0,1,2,3,4,5,6,7,8\n");
    let library = read(&[("s1/s1_a.csv", text.as_bytes())]);
    assert_eq!(library.subjects(), ["own/s1"]);
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [&little[..], &big, &little[2..], &big[2..]] {
        let told = read(&[("s1/s1_a.csv", bytes)]).skipped[0].to_string();
        assert!(told.contains("UTF-16") && told.contains("UTF-8"), "{told}");
    }
}

#[test]
fn no_two_recordings_have_names_that_are_one_file_s() {
    let described = format!(
        "files = \"{{person}}/emg.{{trial}}\"\nchannels = [\"{}\"]\nlabel = \"gt\"\nrate = 200\n\
         labels = {{ relax = [0], close = [2] }}\n",
        [0, 1, 2, 3, 4, 5, 6, 7]
            .map(|c| format!("emg_{c}"))
            .join("\", \"")
    );
    for [files, expected] in cells(
        "a/x.csv a/x.txt | a/x.csv a/x.txt
        a/X.csv a/x.csv | a/X.csv a/x.csv-2
        a/x.csv a/x.csv.txt a/x.txt | a/x.csv a/x.csv-2 a/x.txt
        anna/emg.1 anna/emg.2 bob/emg.1 recordings.toml | anna/emg.1 anna/emg.2 bob/emg",
    ) {
        // Each with samples of its own.
        let text = |(person, file)| match file {
            FILE_NAME => (file, described.clone()),
            _ => (file, own(person)),
        };
        let texts: Vec<_> = (1..).zip(files.split(' ')).map(text).collect();
        let found = names(&read(&texts)).join(" ").replace("own/", "");
        assert_eq!(found, expected);
    }
}

#[test]
fn a_persons_two_arms_are_two_wearers() {
    let rows = |person| rows(&emg(1000, person), |_, own| joined(own, ",") + ",0");
    let right = ("_readings_right_hand/12345-1/7.txt", rows(2));
    let left = ("_readings_left_hand/12345-1/7.txt", rows(1));
    let both = read(&[left, right.clone()]);
    assert_eq!(both.subjects(), ["myo-readings/12345"]);
    assert_ne!(names(&both)[0], names(&both)[1]);
    // Signals of the left arm are not expected of the right one.
    let alone = read(&[right]).recordings.remove(0);
    assert_eq!(both.recordings[1].wearer, alone.wearer);
}

#[test]
fn endings_in_capitals_are_read_as_small_ones() {
    let samples = emg(1000, 1);
    let array = array(&samples);
    let words = crate::npy::encode("|i1", &[1000], &[5; 1000]);
    let rows = rows(&samples, |_, own| joined(own, ","));
    let metadata = r#"{"data/bob/R_0_C_1.csv": {"class_name": "Hand_Open"}}"#;
    let description = "files = \"{person}/{trial}_emg.Npy\"\nlabel_files = \"{person}/{trial}_ann.npy\"\nrate = 200\n\
                       labels = { open = [5] }\n";
    let own = own(1);
    let is_read = |name: &str, files: &[(&str, &[u8])]| {
        let library = read(files);
        assert!(library.skipped.is_empty(), "{:?}", library.skipped);
        assert_eq!(names(&library), [name]);
        assert!(library.recordings[0].has_labels(), "{name}");
    };
    let own: [(&str, &[u8]); 1] = [("anna/anna_1.CSV", own.as_bytes())];
    is_read("own/anna/anna_1", &own);
    let published: [(&str, &[u8]); 2] = [("s3/e2_emg.NPY", &array), ("s3/e2_ann.Npy", &words)];
    is_read("myoup/s3/e2", &published);
    let libemg = [
        ("bob/R_0_C_1.Csv", rows.as_bytes()),
        ("bob/metadata.JSON", metadata.as_bytes()),
    ];
    is_read("own/bob/R_0_C_1", &libemg);
    let described: [(&str, &[u8]); 3] = [
        ("eva/1_emg.NPY", &array),
        ("eva/1_ann.NPY", &words),
        (FILE_NAME, description.as_bytes()),
    ];
    is_read("own/eva/1_emg", &described);
}
