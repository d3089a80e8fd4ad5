//! Guided session: led by a viewer and in a browser, recorded to the sample, over breaks, a kill and a full disk.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use myointent::live::{self, Live, Options, RecordOptions, Source};
use recordings::{LoadOptions, Recording, load};
use serde_json::Value;
use shared::units::Sample;
use training::backend::BackendArguments;
use web::record::protocol::Protocol;

use super::synthetic;
use super::viewer::Viewer;

/// Protocol of two rounds of three openings and three fists: 46 s.
pub const SHORT: &str = "rounds = 2\npause = 1\n\
    sequence = [\"relax\", \"open\", \"relax\", \"close\", \"relax\", \"open\", \"relax\", \"close\", \"relax\", \"open\", \"relax\", \"close\", \"relax\"]\n\
    [seconds]\nrelax = 1.5\nopen = 2\nclose = 2\n";

pub fn record(folder: &Path, source: Source, protocol: &str, speed: u32) -> Live {
    live::start(Options {
        source,
        model: None,
        listen: "127.0.0.1:0".parse().unwrap(),
        imu: false,
        record: Some(RecordOptions {
            folder: folder.to_owned(),
            person: "anna".to_owned(),
            protocol: Protocol::parse("short.toml", protocol).unwrap(),
            model: "models/three-class.intent".into(),
            device: BackendArguments { backend: None }.device().unwrap(),
            speed,
            unattended: false,
        }),
    })
    .unwrap()
}

/// Sends the message of a pressed button.
pub fn wish(viewer: &mut Viewer, wish: &str) {
    viewer.say(&format!(r#"{{"do":"session","wish":"{wish}"}}"#));
}

/// Returns the next message of the session for which `is_wanted` holds, and the number of times that the session had to be
/// told to go on: on a machine that is busy with other work the source may stop for two seconds.
pub fn reach(viewer: &mut Viewer, is_wanted: impl Fn(&Value) -> bool) -> (Value, u64) {
    let mut held = 0;
    loop {
        let message = viewer.find("session", |message| {
            is_wanted(message) || message["phase"] == "held"
        });
        if is_wanted(&message) {
            return (message, held);
        }
        held += 1;
        wish(viewer, "begin");
    }
}

/// Samples of a file by their numbers in the stream; true for a sample that never came and repeats the one before.
pub type Numbered = BTreeMap<usize, (Sample, bool)>;

/// Reads the files of every person in a folder, each by itself: a recording that is replayed repeatedly gives files of
/// equal samples, which count only once if read together.
pub fn recorded(folder: &Path) -> Vec<Numbered> {
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).unwrap().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    };
    let people = entries(folder).into_iter().filter(|path| path.is_dir());
    let files = people.flat_map(|person| entries(&person));
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "csv"));
    let numbered = |recording: &Recording| {
        let text = std::fs::read_to_string(&recording.path).unwrap();
        let row = |(line, &sample): (&str, &Sample)| {
            let cells: Vec<&str> = line.split(',').collect();
            (cells[9].parse().unwrap(), (sample, cells[13] == "1"))
        };
        let lines = text.lines().skip(1);
        lines.zip(&recording.samples).map(row).collect()
    };
    let read = |file: PathBuf| load(&file, &LoadOptions::default()).unwrap().recordings;
    files.flat_map(read).map(|one| numbered(&one)).collect()
}

/// Asserts that every recorded sample equals the source's, or repeats the one before if a busy machine lost it on the
/// line, and that none is missing within a file. Returns the number of samples.
pub fn assert_equal(files: &[Numbered], source: &[Sample]) -> usize {
    for file in files {
        let (first, last) = (file.keys().next().unwrap(), file.keys().last().unwrap());
        assert_eq!(file.len(), last - first + 1, "a gap");
        let mut before = None;
        for (number, &(sample, is_bridged)) in file {
            let expected = before
                .filter(|_| is_bridged)
                .unwrap_or(source[number % source.len()]);
            assert_eq!(sample, expected, "{number}");
            before = Some(sample);
        }
    }
    files.iter().map(BTreeMap::len).sum()
}

/// Builds an expression that is true if the session is in a phase.
pub fn phase(name: &str) -> String {
    format!("$session?.dataset.phase === '{name}'")
}

/// Builds an expression that is true if a step is in the state `done`, `now` or `next`.
pub fn step(name: &str, state: &str) -> String {
    format!("$step-{name}?.dataset.state === '{state}'")
}

/// The short protocol with a movement that means nothing in each round.
pub fn short_with_point() -> String {
    SHORT
        .replace("\"relax\"]", "\"relax\", \"point\", \"relax\"]")
        .replace("[seconds]", "[seconds]\npoint = 3")
}

/// Builds an expression that is true if an element can be seen.
pub fn is_seen(id: &str) -> String {
    format!("${id}?.offsetParent instanceof Element")
}

/// Folder for pictures of the page, for a person to look at.
pub fn pictures() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("live");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_session_is_recorded_sample_for_sample_and_led_by_one_viewer() {
    let folder = tempfile::tempdir().unwrap();
    let recording = synthetic(20);
    let samples = recording.samples.clone();
    let live = record(
        folder.path(),
        Source::Replay(Box::new(recording)),
        SHORT,
        16,
    );
    let mut leader = Viewer::connect(live.url());
    let mut other = Viewer::connect(live.url());
    leader.find("samples", |_| true);
    wish(&mut leader, "begin");
    leader.find("lead", |message| message["viewer"].is_u64());
    // A viewer that only watches can do nothing.
    wish(&mut other, "finish");
    wish(&mut other, "hold");
    let (_, mut held) = reach(&mut leader, |message| message["cue"] == "open");
    wish(&mut leader, "repeat");
    held += reach(&mut leader, |message| message["bad"].as_u64() > Some(held)).1;
    held += reach(&mut leader, |message| message["phase"] == "over").1;
    live.stop().unwrap();
    let files = recorded(folder.path());
    let count = assert_equal(&files, &samples);
    // Two rounds, and what was repeated.
    assert!(count >= 2 * 4700, "{count}");
    let left: Vec<_> = std::fs::read_dir(folder.path().join("anna"))
        .unwrap()
        .flatten()
        .collect();
    assert_eq!(left.len(), files.len(), "{left:?}");
    let expected = 2..=2 + held as usize;
    assert!(expected.contains(&files.len()), "{left:?}");
}

#[test]
fn a_leader_who_leaves_holds_the_session_and_the_next_one_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, SHORT, 8);
    let mut leader = Viewer::connect(live.url());
    let mut other = Viewer::connect(live.url());
    leader.find("samples", |_| true);
    wish(&mut leader, "begin");
    other.find("session", |message| message["cue"] == "open");
    drop(leader);
    let held = other.find("session", |message| message["phase"] == "held");
    assert_eq!(held["why"], "leader-left", "{held}");
    wish(&mut other, "begin");
    reach(&mut other, |message| message["cue"] == "open");
    // Ctrl-C: what was recorded is kept.
    live.stop().unwrap();
    assert!(!recorded(folder.path()).is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_board_that_is_lost_in_a_session_costs_the_gesture_in_progress_alone() {
    use super::board::{Board, Damage};

    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(&link, Damage::None);
    let live = record(folder.path(), Source::Port(link.clone()), SHORT, 1);
    let mut viewer = Viewer::connect(live.url());
    viewer.find("samples", |_| true);
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["cue"] == "close");
    drop(board);
    viewer.find("session", |message| message["why"] == "source-lost");
    let board = Board::start(&link, Damage::None);
    viewer.find("source", |message| message["connected"] == true);
    viewer.find("samples", |_| true);
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["done"] == 3);
    wish(&mut viewer, "finish");
    let kept = viewer.find("kept", |_| true);
    assert!(kept["files"].as_array().unwrap().len() >= 2, "{kept}");
    live.stop().unwrap();
    drop(board);
    let source = super::synthetic(60).samples;
    let count = assert_equal(&recorded(folder.path()), &source);
    assert!(count > 200 * 10, "{count}");
}
