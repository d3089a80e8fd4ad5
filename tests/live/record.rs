//! Guided session: led by a viewer and in a browser, recorded to the sample, over breaks, a kill and a full disk.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use myointent::live::{self, Live, Options, RecordOptions, Source};
use myointent::record::protocol::Protocol;
use recordings::{LoadOptions, Recording, load};
use serde_json::Value;
use shared::units::Sample;
use training::backend::BackendArguments;

use super::browser::Browser;
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

/// Returns the next message of the session for which `is_it` holds, and the number of times that the session had to be
/// told to go on: on a machine that is busy with other work the source may stop for two seconds.
pub fn reach(viewer: &mut Viewer, is_it: impl Fn(&Value) -> bool) -> (Value, u64) {
    let mut held = 0;
    loop {
        let message = viewer.find("session", |message| {
            is_it(message) || message["phase"] == "held"
        });
        if is_it(&message) {
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

/// Builds an expression that is true if a step is in the state `done`, `now` or `next`.
pub fn step(name: &str, state: &str) -> String {
    format!("document.getElementById('step-{name}')?.dataset.state === '{state}'")
}

/// Builds an expression that is true if an element can be seen.
pub fn is_seen(id: &str) -> String {
    format!("document.getElementById('{id}')?.offsetParent instanceof Element")
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

#[test]
fn a_guided_session_in_a_browser_ends_with_a_tuned_model() {
    let name = "a_guided_session_in_a_browser_ends_with_a_tuned_model";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // With a movement that means nothing in each round.
    let protocol = SHORT
        .replace("\"relax\"]", "\"relax\", \"point\", \"relax\"]")
        .replace("[seconds]", "[seconds]\npoint = 3");
    let live = record(folder.path(), Source::Demo, &protocol, 4);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for("document.getElementById('source')?.dataset.state === 'connected'");
    let phase =
        |phase: &str| format!("document.getElementById('session')?.dataset.phase === '{phase}'");
    browser.wait_for(&phase("waiting"));
    let shown =
        "!document.getElementById('session').hidden && document.title === 'myointent record'";
    assert_eq!(browser.value(shown), true);
    let steps = "[...document.querySelectorAll('#steps li')].map((step) => `${step.id} ${step.dataset.state}`).join()";
    assert_eq!(
        browser.value(steps),
        "step-connect done,step-record now,step-tune next,step-compare next"
    );
    assert_eq!(
        browser.value("document.getElementById('legend').offsetParent"),
        Value::Null,
        "a legend of scores that are not drawn"
    );
    browser.press("Enter");
    let task = |text: &str| format!("document.getElementById('task').textContent === '{text}'");
    browser.wait_for(&task("Open the hand wide"));
    assert_eq!(
        browser.value("document.getElementById('hand').childElementCount > 10"),
        true
    );
    assert_eq!(
        browser.value("Number(document.getElementById('count').textContent) > 0"),
        true
    );
    browser.press("r");
    browser.wait_for("document.getElementById('progress').textContent.includes('1 not used')");
    browser.wait_for(&task("Make a fist"));
    browser.press("h");
    browser.wait_for(&phase("held"));
    assert_eq!(browser.text("task"), "Waiting for you");
    let end = Instant::now() + Duration::from_secs(200);
    while browser.value(&phase("over")) != true {
        assert!(Instant::now() < end, "{}", browser.text("session"));
        if browser.value(&phase("held")) == true {
            browser.press("Enter");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    browser.wait_for("!document.getElementById('result').hidden");
    assert!(
        browser.text("verdict").starts_with("Good enough"),
        "{}",
        browser.text("result")
    );
    assert!(
        browser
            .text("commands")
            .contains("myointent personalize --model")
    );
    let main =
        "[...document.querySelectorAll('#result button.main')].map((button) => button.id).join()";
    assert_eq!(browser.value(main), "tune");
    let mut beside = Viewer::connect(live.url());
    beside.find("samples", |_| true);
    browser.press("t");
    // Tuning takes some seconds of both cores, which may be busy.
    let tuning = "document.getElementById('tuned').dataset.state === 'running'";
    browser.wait_for("Boolean(document.getElementById('tuned').dataset.state)");
    let end = Instant::now() + Duration::from_secs(400);
    let mut shares = Vec::new();
    while shares.last() != Some(&(0, 0)) {
        assert!(Instant::now() < end, "{}", browser.text("tuned"));
        let message = beside.next().expect("a message, not the end");
        if message["type"] == "tuning" {
            let number = |field: &str| message[field].as_u64().unwrap();
            shares.push((number("steps"), number("of")));
        }
    }
    // Progress comes before the first step and after each; then it is over.
    // Of how many, is known with the first step.
    let of = shares[1].1;
    let expected = (1..=of).map(|steps| (steps, of)).chain([(0, 0)]);
    assert!(of >= 40 && shares[0].0 == 0, "{shares:?}");
    assert!(shares[1..].iter().copied().eq(expected), "{shares:?}");
    browser.wait_for(&format!("!({tuning})"));
    let state = browser.value("document.getElementById('tuned').dataset.state");
    let written = folder.path().join("anna/anna.intent").exists();
    assert_ne!(state, "failed", "{}", browser.text("tuned"));
    assert_eq!(written, state == "better", "{}", browser.text("tuned"));
    assert_eq!(browser.text("commands").contains("install"), written);
    // There is no board.
    assert_eq!(
        browser.value("document.getElementById('install').hidden"),
        true
    );
    let scores = browser.text("scores");
    for row in ["balanced accuracy", "other movements that raise a label"] {
        assert!(scores.contains(row), "{scores}");
    }
    let told = browser.text("tuned");
    for half in [
        "Of the gestures ",
        "A minute of movement that means nothing raises ",
    ] {
        assert!(told.contains(half), "{told}");
    }
    let headline = if written {
        "A model of your own is ready"
    } else {
        "The old model stays"
    };
    assert!(
        browser.text("verdict").starts_with(headline),
        "{}",
        browser.text("verdict")
    );
    let drawn = "[...document.querySelectorAll('#scores tbody tr')].every((row) => row.querySelectorAll('.bars i').length === 2)";
    assert_eq!(browser.value(drawn), true);
    let copy = "document.querySelector('.command button')";
    browser.value(&format!("{copy}.click()"));
    browser.wait_for(&format!(
        "['Copied', 'Selected'].includes({copy}.textContent)"
    ));
    for done in ["record", "tune", "compare"] {
        assert_eq!(browser.value(&step(done, "done")), true, "{done}");
    }
    assert!(browser.text("step-compare").contains("tuned"));
    let next = if written { "" } else { "again" };
    assert_eq!(browser.value(main), next);
    browser.screenshot(&pictures().join("record-result.png"));
    browser.press("n");
    browser.wait_for(&phase("waiting"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["synthetic/anna"]);
}

#[test]
#[ignore = "pictures of a session in real time, for docs/record.md"]
fn pictures_of_a_session() {
    let Some(mut browser) = Browser::start("pictures_of_a_session") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let text = myointent::record::protocol::text("quick-six").unwrap();
    let live = record(folder.path(), Source::Demo, &text, 1);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for("document.getElementById('session')?.dataset.phase === 'waiting'");
    std::thread::sleep(Duration::from_millis(4500));
    browser.screenshot(&pictures().join("record-waiting.png"));
    browser.press("Enter");
    for (text, name, width, height, scheme) in [
        ("Open the hand wide", "open", 1440, 900, "light"),
        ("Make a fist", "close", 1440, 900, "dark"),
        (
            "Bend the wrist towards the palm",
            "wave-in",
            390,
            844,
            "light",
        ),
        (
            "Bend the wrist away from the palm",
            "wave-out",
            1440,
            900,
            "light",
        ),
        (
            "Touch the thumb with the index finger",
            "pinch",
            1024,
            700,
            "light",
        ),
    ] {
        browser.wait_for(&format!(
            "document.getElementById('task').textContent === '{text}'"
        ));
        browser.look(width, height, scheme, "no-preference");
        std::thread::sleep(Duration::from_millis(1600));
        browser.screenshot(&pictures().join(format!("record-{name}.png")));
        let fits = "document.documentElement.scrollWidth <= innerWidth";
        assert_eq!(browser.value(fits), true, "{name} is wider than the window");
    }
    browser.look(1440, 900, "light", "no-preference");
    browser.press("e");
    browser.press("e");
    browser.wait_for("!document.getElementById('result').hidden");
    browser.screenshot(&pictures().join("record-early.png"));
    live.stop().unwrap();
}
