//! Tables that are not one sample a row, as files below a folder: refused in words that name the fault by every reader,
//! or read.

use std::fmt::Write as _;

use shared::intent::Intent;
use shared::units::Sample;

use crate::description::draft::describe;
use crate::fixture::{HEADER, emg, folder, joined, read};
use crate::library::inspection::groups;
use crate::{Library, LoadOptions, load};

/// Rows of a table of one person.
fn rows(of: impl Fn(usize, &Sample) -> String) -> String {
    crate::fixture::rows(&emg(1000, 1), of)
}

fn own(mark: &str) -> String {
    let rows = rows(|_, sample| format!("0{mark}{}", joined(sample, mark)));
    HEADER.replace(',', mark) + &rows
}

/// Rows of so many samples each, with what stands around them.
fn windows(samples: usize, around: [&str; 2], value: impl Fn(i8) -> String) -> String {
    let all = emg(1000, 1);
    let row = |own: &[Sample]| {
        let values: Vec<String> = own.iter().flatten().map(|&count| value(count)).collect();
        format!("{}{}{}\n", around[0], values.join(","), around[1])
    };
    all.chunks_exact(samples).map(row).collect()
}

/// Words of a load about the only file, and of a description of its folder.
fn told(text: &str) -> (String, String) {
    let folder = folder(&[("anna/anna_1.csv", text)]);
    let loaded = match load(folder.path(), &LoadOptions::default()) {
        Ok(Library { skipped, .. }) => skipped.first().map(ToString::to_string),
        Err(error) => Some(error.to_string()),
    };
    let described =
        describe(folder.path(), None).map_or_else(|error| error.to_string(), |own| own.1);
    (loaded.unwrap_or_default(), described)
}

#[test]
fn what_is_not_one_sample_a_row_is_refused_in_words_that_name_the_fault() {
    let whole = |count: i8| count.to_string();
    let decimal = |count: i8| (f64::from(count) / 128.0).to_string();
    let kinds = |first: usize, second: usize| {
        rows(|at, sample| {
            let time = format!("\"10:00:{:06.3}\"", at as f64 / 200.0);
            let emg = format!("{time},\"emg\",\"{}\"\n", joined(sample, "\",\""));
            emg.repeat(first)
                + &vec![format!("{time},\"imu\",\"0\",\"0\",\"0\""); second].join("\n")
        })
    };
    let named = |names: Vec<String>| {
        let row = joined(&vec!["0.5"; names.len()], ",") + "\n";
        format!("{}\n{}", names.join(","), row.repeat(700))
    };
    let numbered = |words: &[&str], count: usize| -> Vec<String> {
        let name = |at| format!("{}{}", words[at / count], at % count);
        (0..words.len() * count).map(name).collect()
    };
    let lists = (0..20).fold(String::new(), |mut text, row| {
        let samples = emg(50, row);
        let samples: Vec<_> = samples.iter().map(|own| format!("{own:?}")).collect();
        let _ = writeln!(text, "rest [{}]", samples.join(", "));
        text
    });
    let titled = |title: &str, mark: &str| format!("{title}\n{}", own(mark));
    let counted = rows(|_, own| joined(own, ","));
    let eight = "8 samples a row";
    for (text, words) in [
        (titled("Recording of Anna", ","), "found it in line 2"),
        (titled("Anna;;;;;;;;", ";"), "found it in line 2"),
        (titled("Anna\t2024\nleft\n", "\t"), "found it in line 4"),
        (format!("Anna 1 2 3\n{counted}"), "8 in line 2"),
        // Rows of two kinds, in turn and with more of the other.
        (kinds(1, 1), "found 10 values here and 5 in line 2"),
        (kinds(1, 3), "found 10 values here and 5 in line 2"),
        (windows(8, ["", ""], whole), eight),
        (windows(8, ["", ",3"], whole), eight),
        (windows(8, ["1,", ""], decimal), eight),
        (windows(8, ["", ",rest"], whole), eight),
        (windows(50, ["", ",1"], whole), "50 samples a row"),
        (named(numbered(&["emg_"], 64)), eight),
        (
            named(numbered(&["s_ch", "t_ch", "u_ch", "v_ch"], 8)),
            "4 samples a row",
        ),
        (lists, "lists in brackets"),
    ] {
        let start: String = text.chars().take(60).collect();
        let (loaded, described) = told(&text);
        assert!(loaded.contains(words), "{start}: {loaded}");
        assert!(described.contains(words), "{start}: {described}");
    }
    let features = windows(2, ["", ""], |count| {
        (f64::from(count) * 0.713 + 0.1).sin().to_string()
    });
    let names = [numbered(&["zcr ", "sch "], 8), numbered(&[""], 16)];
    for text in names.map(named).into_iter().chain([features]) {
        let (loaded, described) = told(&text);
        let both = loaded + "\n" + &described;
        assert!(!both.contains("armbands"), "{both}");
    }
}

#[test]
fn rows_of_separators_alone_are_passed_over() {
    for (mark, blank) in [
        (",", ",,,,,,,,"),
        (";", ";;;;;;;;"),
        ("\t", "\t\t\t\t\t\t\t\t"),
        (",", "\"\",\"\",\"\",\"\",\"\",\"\",\"\",\"\",\"\""),
        (",", " , , "),
        (",", ""),
    ] {
        let text = own(mark);
        let (head, rest) = text.split_at(text.len() / 2);
        let (line, rest) = rest.split_once('\n').unwrap();
        for blanked in [
            format!("{text}{blank}\n{blank}\n"),
            format!("{text}{blank}\r\n{blank}"),
            format!("{head}{line}\n{blank}\n{rest}"),
            format!("{blank}\n{text}"),
        ] {
            let library = read(&[("anna/1.csv", &blanked)]);
            assert!(library.skipped.is_empty(), "{blank}: {:?}", library.skipped);
            assert_eq!(library.recordings[0].samples.len(), 1000, "{blank}");
        }
    }
}

#[test]
fn a_word_beside_the_channels_makes_no_header() {
    let words = ["rest", "fist"];
    let before = |at: usize| words[at / 200 % 2].to_owned() + ",";
    let behind = |at: usize| ",".to_owned() + words[at / 200 % 2];
    for (text, label) in [
        (rows(|at, own| joined(own, ",") + &behind(at)), "label = 9"),
        (rows(|at, own| before(at) + &joined(own, ",")), "label = 1"),
        (
            rows(|at, own| joined(own, ",") + &behind(at) + ",a"),
            "label = 9",
        ),
    ] {
        let folder = folder(&[
            ("anna/1.csv", &text),
            ("bob/1.csv", &text.replacen("fist", "rest", 100)),
        ]);
        let loaded = load(folder.path(), &LoadOptions::default()).unwrap();
        let refused = loaded.skipped[0].to_string();
        assert!(refused.contains("no header that says"), "{refused}");
        let (_, text) = describe(folder.path(), None).unwrap();
        for line in ["header = false", label, "files = \"{person}/1.csv\""] {
            assert!(text.lines().any(|own| own == line), "{line}: {text}");
        }
        let read = load(folder.path(), &LoadOptions::default()).unwrap();
        assert_eq!(read.recordings[0].samples.len(), 1000);
    }
}

/// Text of a row in the column of a class.
type Label<'l> = &'l dyn Fn(usize, usize) -> String;

#[test]
fn a_column_for_each_class_is_read_or_told() {
    let class = |at: usize| at / 100 % 3;
    let read = |names: &str, of: Label<'_>| {
        let row = |at: usize| (0..3).map(|own| of(at, own)).collect::<Vec<_>>().join(",");
        let rows = rows(|at, own| format!("{},{}", joined(own, ","), row(at)));
        let text = format!("{},{names}\n{rows}", &HEADER.trim_end()[3..]);
        let library = read(&[("anna/1.csv", text)]);
        let told = groups(&library).into_iter().map(|own| own.finding.what);
        let told: Vec<String> = told.collect();
        (library.recordings[0].labels.clone(), told.join("; "))
    };
    let number = |at: usize, own: usize| u8::from(class(at) == own).to_string();
    let decimal = |at: usize, own: usize| format!("{}.0", u8::from(class(at) == own));
    let word = |at: usize, own: usize| if class(at) == own { "True" } else { "False" }.to_owned();
    let intents = [Intent::Relax, Intent::Open, Intent::Close].map(Some);
    let expected: Vec<_> = (0..1000).map(|at| intents[class(at)]).collect();
    let kinds: [(&str, Label<'_>); 4] = [
        ("relax,open,close", &number),
        ("Rest,Hand_Open,Fist", &decimal),
        ("label_relax,label_open,label_close", &word),
        ("is_rest,is_open,is_fist", &number),
    ];
    for (names, of) in kinds {
        let (labels, told) = read(names, of);
        assert_eq!(labels, expected, "{names}: {told}");
        assert!(told.contains("labels are read from columns"), "{told}");
    }
    let both = |_: usize, _: usize| "1".to_owned();
    let unread: [(&str, Label<'_>); 2] = [("a,b,c", &number), ("relax,open,close", &both)];
    for (names, of) in unread {
        let (labels, told) = read(names, of);
        assert_eq!(labels, [None; 1000], "{names}");
        let words = "look like a label each and are not read";
        assert!(told.contains(words), "{names}: {told}");
    }
    // A switch beside the channels is no label.
    let (_, told) = read("led,button,x", &|at, own| {
        u8::from(at % (7 + own) == 0).to_string()
    });
    assert!(told.is_empty(), "{told}");
}
