//! Folders of other people's layouts, read by the description that `data describe` writes and a person mends: what it
//! wrote, what was mended, and the seconds of each class that came of it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use recordings::description::draft::describe;
use recordings::library::inspection::Inspection;
use recordings::{Library, LoadOptions, load};
use serde::Deserialize;
use tempfile::TempDir;

use super::recorded;

/// A layout, and what comes of it; `layouts.toml` says what each field means.
#[derive(Deserialize)]
struct Layout {
    set: Option<String>,
    case: Option<String>,
    wrote: String,
    mended: String,
    found: (usize, usize, String),
}

#[derive(Deserialize)]
struct Layouts {
    layout: Vec<Layout>,
}

/// Lines of a description without comments, and without the folder, which differs.
fn lines(text: &str) -> Vec<&str> {
    let is_field =
        |line: &&str| !line.is_empty() && !line.starts_with('#') && !line.starts_with("folder");
    text.lines().filter(is_field).collect()
}

/// The description of a folder as written and as mended, in a folder of its own.
fn mended(folder: &Path, mended: &[&str]) -> (String, PathBuf, TempDir) {
    let own = tempfile::tempdir().unwrap();
    let path = own.path().join("mine.toml");
    let (_, wrote) = describe(folder, Some(&path)).unwrap();
    let field = |line: &str| line.split(" = ").next().unwrap_or_default().to_owned();
    let is_mended = |line: &str| mended.iter().any(|own| field(own) == field(line));
    let kept = wrote.lines().filter(|line| !is_mended(line));
    let text: Vec<&str> = kept.chain(mended.iter().copied()).collect();
    std::fs::write(&path, text.join("\n") + "\n").unwrap();
    (wrote, path, own)
}

/// Seconds by class, as `data inspect` shows them.
fn seconds(library: &Library) -> String {
    let Inspection { sets, .. } = Inspection::new(library);
    let mut seconds: BTreeMap<&str, f64> = BTreeMap::new();
    for set in &sets {
        for (&intent, own) in &set.seconds_by_intent {
            *seconds.entry(intent).or_default() += own;
        }
        *seconds.entry("~other").or_default() += set.seconds_other_movement;
        *seconds.entry("~unlabelled").or_default() += set.seconds_unlabelled;
    }
    let told = seconds.iter().filter(|(_, seconds)| **seconds >= 0.5);
    let told: Vec<String> = told
        .map(|(class, seconds)| format!("{} {seconds:.0}", class.trim_start_matches('~')))
        .collect();
    told.join(", ")
}

#[test]
fn real_layouts_are_described_and_mended_in_few_lines() {
    let Layouts { layout } = toml::from_str(include_str!("layouts.toml")).unwrap();
    std::thread::scope(|scope| {
        for layout in layout {
            scope.spawn(|| is_described_and_mended(layout));
        }
    });
}

fn is_described_and_mended(layout: Layout) {
    // Small inputs lie beside the recordings.
    let case = layout.case.map(|case| format!("../cases/{case}"));
    let Some(folder) = layout.set.or(case).and_then(|path| recorded(&path)) else {
        return;
    };
    let place = folder.display();
    let lines_of_it: Vec<&str> = layout.mended.lines().collect();
    assert!(lines_of_it.len() < 5, "{place}: mended in under five lines");
    let (wrote, path, _own) = mended(&folder, &lines_of_it);
    let expected: Vec<&str> = layout.wrote.lines().collect();
    assert_eq!(lines(&wrote), expected, "{place}");
    let library = load(&path, &LoadOptions::default()).unwrap();
    let found = (
        library.subjects().len(),
        library.recordings.len(),
        seconds(&library),
    );
    assert_eq!(found, layout.found, "{place}");
}
