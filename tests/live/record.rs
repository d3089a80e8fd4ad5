//! Guided session, led by viewers and recorded to the sample; and what the tests of sessions share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use myointent::live::{self, Live, Options, RecordOptions, Source};
use recordings::{LoadOptions, Recording, load};
use serde_json::Value;
use shared::units::Sample;
use training::backend::BackendArguments;
use web::record::protocol::Protocol;

use super::viewer::Viewer;
use super::{options, synthetic};

/// Protocol of two rounds of three openings and three fists: 46 s.
pub const SHORT: &str = "rounds = 2\npause = 1\n\
    sequence = [\"relax\", \"open\", \"relax\", \"close\", \"relax\", \"open\", \"relax\", \"close\", \"relax\", \"open\", \"relax\", \"close\", \"relax\"]\n\
    [seconds]\nrelax = 1.5\nopen = 2\nclose = 2\n";

/// Starts the page of a session of `anna`, on any free port of this machine.
pub fn record(folder: &Path, source: Source, protocol: &str, speed: u32) -> Live {
    record_with(folder, source, None, protocol, speed)
}

/// Starts the page of a session with a model.
pub fn record_with(
    folder: &Path,
    source: Source,
    model: Option<Vec<u8>>,
    protocol: &str,
    speed: u32,
) -> Live {
    let record = RecordOptions {
        folder: folder.to_owned(),
        person: "anna".to_owned(),
        protocol: Protocol::parse("short.toml", protocol).unwrap(),
        model: "models/three-class.intent".into(),
        device: BackendArguments { backend: None }.device().unwrap(),
        speed,
        unattended: false,
    };
    let options = Options {
        model,
        record: Some(record),
        ..options(source)
    };
    live::start(options).unwrap()
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
fn a_session_is_recorded_sample_for_sample_and_led_by_one_viewer_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let recording = synthetic(20);
    let samples = recording.samples.clone();
    let source = Source::Replay(Box::new(recording));
    let live = record(folder.path(), source, SHORT, 16);
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
    // The session waits for the next one who leads.
    drop(leader);
    other.find("session", |message| message["why"] == "leader-left");
    wish(&mut other, "begin");
    held += 1 + reach(&mut other, |message| message["phase"] == "over").1;
    live.stop().unwrap();
    let files = recorded(folder.path());
    let count = assert_equal(&files, &samples);
    // Two rounds, and what was repeated.
    assert!(count >= 2 * 4700, "{count}");
    let left = std::fs::read_dir(folder.path().join("anna")).unwrap();
    let left: Vec<_> = left.flatten().collect();
    assert_eq!(left.len(), files.len(), "{left:?}");
    let expected = 2..=2 + held as usize;
    assert!(expected.contains(&files.len()), "{left:?}");
}
