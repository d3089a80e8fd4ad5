//! Channels and labels found by the names of their columns, and refusals.

use recordings::{LoadOptions, load};
use shared::intent::Intent;
use shared::units::Sample;

use super::{bare, folder, npy_of, own, read_one, row, sample};

/// Writes rows of a person with a header, each made from number and sample.
fn table(header: &str, row: impl Fn(u32, &Sample) -> String) -> String {
    let rows = (0..700).map(|at| row(at, &sample(1, at)));
    std::iter::once(header.to_owned())
        .chain(rows)
        .collect::<Vec<_>>()
        .join("\n")
}

fn emg(separator: &str) -> impl Fn(u32, &Sample) -> String {
    move |_, sample| row(sample, separator)
}

fn is_read(name: &str, text: &str) {
    let folder = folder(&[(name, text)]);
    for path in [folder.path().to_owned(), folder.path().join(name)] {
        let library =
            load(&path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let skipped: Vec<String> = library.skipped.iter().map(ToString::to_string).collect();
        assert!(skipped.is_empty(), "{skipped:?}");
        assert_eq!(library.recordings[0].samples.len(), 700, "{name}");
        for at in [0, 5, 699] {
            assert_eq!(
                library.recordings[0].samples[at as usize],
                sample(1, at),
                "{name}"
            );
        }
    }
}

/// Returns eight names, numbered from `first` on.
fn eight(before: &str, after: &str, first: u32, separator: &str) -> String {
    let name = |number| format!("{before}{number}{after}");
    let names: Vec<String> = (first..first + 8).map(name).collect();
    names.join(separator)
}

#[test]
fn eight_channels_are_found_by_name() {
    let time = |at: u32| 1_444_331_136_000_000 + 5000 * u64::from(at);
    let header = format!("timestamp,{}", eight("emg", "", 1, ","));
    let stamped = |at: u32, own: &Sample| format!("{},{}", time(at), row(own, ","));
    is_read("time.csv", &table(&header, stamped));
    let header = format!("{},Time", eight("channel_", "", 1, ","));
    let behind = |at: u32, own: &Sample| format!("{},{}", row(own, ","), 0.005 * f64::from(at));
    is_read("behind.csv", &table(&header, behind));
    let numbered = |at: u32, own: &Sample| format!("{at},{}", row(own, ","));
    is_read("pandas.csv", &table(",0,1,2,3,4,5,6,7", numbered));
    for (name, header, separator) in [
        ("upper.txt", eight("EMG ", "", 0, "\t"), "\t"),
        ("unit.csv", eight("Ch", " [uV]", 1, ","), ","),
        ("quoted.csv", eight("\"emg.", "\"", 1, ";"), ";"),
    ] {
        is_read(name, &table(&header, emg(separator)));
    }
}

#[test]
fn labels_are_found_by_name() {
    let header = "label;emg_0;emg_1;emg_2;emg_3;emg_4;emg_5;emg_6;emg_7";
    let text = table(header, |at, own| {
        let label = if at < 100 { "relax" } else { "close" };
        format!("{label};{}", row(own, ";"))
    });
    is_read("anna.csv", &text);
    let folder = folder(&[("anna.csv", text)]);
    let labels = read_one(folder.path()).labels;
    assert_eq!(
        (labels[99], labels[100]),
        (Some(Intent::Relax), Some(Intent::Close))
    );
}

#[test]
fn eight_columns_without_a_header_are_read_if_they_are_asked_for() {
    for (name, text) in [
        ("comma.csv", bare(1, ",")),
        ("tab.txt", bare(1, "\t")),
        ("space.txt", bare(1, " ")),
        ("semicolon.csv", bare(1, ";")),
    ] {
        let folder = folder(&[(name, text)]);
        let recording = read_one(&folder.path().join(name));
        assert_eq!(recording.samples[699], sample(1, 699), "{name}");
        assert!(!recording.has_labels());
    }
    let index = (0..700).map(|at| format!("{},{at}\n", row(&sample(1, at), ",")));
    let folder = folder(&[("index.csv", index.collect::<String>())]);
    assert_eq!(
        read_one(&folder.path().join("index.csv")).samples[5],
        sample(1, 5)
    );
}

/// Returns the message about a file that is named by itself.
fn refusal(name: &str, bytes: &[u8]) -> String {
    let folder = folder(&[(name, bytes)]);
    match load(&folder.path().join(name), &LoadOptions::default()) {
        Ok(library) => {
            assert!(library.recordings.is_empty(), "{name} is read");
            library.skipped[0].to_string()
        }
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_refusal_says_what_was_found_and_what_was_expected() {
    let nine = (0..700).map(|at| format!("{},{}\n", at % 3, row(&sample(1, at), ",")));
    let sixteen: Vec<String> = (0..16).map(|n| format!("emg_{n}")).collect();
    let sixteen = table(&sixteen.join(","), |at, own| {
        format!("{},{}", row(own, ","), row(&sample(2, at), ","))
    });
    let decimals: String = (0..700)
        .map(|at| {
            let volts = sample(1, at).map(|count| (f64::from(count) / 128.0).to_string());
            volts.join(",") + "\n"
        })
        .collect();
    let utf16: Vec<u8> = own(1).encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin = [b"gt,emg_0 \xb5V\n".as_slice(), own(1).as_bytes()].concat();
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n";
    let page = "<!DOCTYPE html>\n<html><body>a,b</body></html>\n";
    let nine: String = nine.collect();
    for (name, bytes, words) in [
        ("nine.csv", nine.as_bytes(), "9 columns|header"),
        (
            "sixteen.csv",
            sixteen.as_bytes(),
            "2 armbands|emg_8 to emg_15",
        ),
        (
            "decimals.csv",
            decimals.as_bytes(),
            "whole numbers from -128 to 127|divided by 128",
        ),
        ("utf16.csv", &utf16, "UTF-16|UTF-8"),
        ("latin.csv", &latin, "UTF-8"),
        (
            "notes.csv",
            b"Dear reader,\nthis is no recording.\n",
            "text",
        ),
        ("nine.npy", &npy_of(1, 9), "(700, 9)|eight|label"),
        ("wide.npy", &npy_of(1, 700), "(700, 700)|(n, 8)"),
        ("pointer.npy", pointer.as_bytes(), "Git LFS|git lfs pull"),
        ("page.csv", page.as_bytes(), "HTML"),
        ("archive.csv", b"PK\x03\x04\x14\x00\x00\x00", "zip"),
        ("model.dat", b"myointnt\x07", "model"),
        ("empty.csv", b"", "empty"),
    ] {
        let message = refusal(name, bytes);
        for word in words.split('|') {
            assert!(message.contains(word), "{name}: {message}");
        }
        for other in ["12345-1/7.txt", "sub7/", "s3/s3_", "classe_"] {
            assert!(!message.contains(other), "{name}: {message}");
        }
    }
}

#[test]
fn a_folder_of_files_that_are_not_read_says_what_they_are() {
    let folder = folder(&[("anna/1.npy", "version https://git-lfs.github.com/spec/v1\n")]);
    let library = load(folder.path(), &LoadOptions::default());
    let message = match &library {
        Ok(library) => library.skipped[0].to_string(),
        Err(error) => error.to_string(),
    };
    assert!(message.contains("git lfs pull"), "{message}");
}
