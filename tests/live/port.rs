//! Board on a pseudo-terminal: asked what it is, and pulled at 100 random moments of a session.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use myointent::live::{self, Options, Source};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::board::{Board, CUTS};
use super::record::{SHORT, assert_equal, record, recorded, wish};
use super::viewer::Viewer;
use super::{options, shipped, synthetic};

#[test]
fn a_board_is_asked_what_it_is_and_shown_with_samples_labels_and_scores() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(&link);
    let live = live::start(Options {
        model: Some(shipped()),
        ..options(Source::Port(link))
    })
    .unwrap();
    let mut viewer = Viewer::connect(live.url());
    viewer.find("source", |source| source["connected"] == true);
    let identity = viewer.find("board", |_| true);
    assert_eq!(identity["image"], "test");
    assert_eq!(identity["battery"], 80);
    assert_eq!(identity["armband"], "FA:12:34:56:78:9A");
    assert_eq!(viewer.find("counts", |_| true)["notifications"], 1000);
    let samples = viewer.find("samples", |_| true);
    let first = samples["first"].as_u64().unwrap() as usize;
    let expected = &synthetic(60).samples[first..][..2];
    assert_eq!(samples["emg"], serde_json::to_value(expected).unwrap());
    viewer.find("report", |report| {
        report["is_label"] == true && report["valid"] == true
    });
    viewer.find("scores", |_| true);
    viewer.say(r#"{"do":"align"}"#);
    viewer.find("alignment", |alignment| alignment["state"] == "waiting");
    assert!(board.is_raw());
    live.stop().unwrap();
    // The board's raw stream is off again, as it was found.
    let end = Instant::now() + Duration::from_secs(10);
    while board.is_raw() {
        assert!(Instant::now() < end, "the raw stream is still on");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_line_pulled_at_100_random_moments_of_a_session_loses_nothing_that_came() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let mut random = ChaCha8Rng::seed_from_u64(31);
    // Cuts fall between the first command of the dialogue and a second of samples after it.
    let dialogues = (0..CUTS).map(|_| f64::exp(random.random_range(0.0..9.0)) as usize + 1);
    let board = Board::pulled(&link, dialogues.collect());
    let live = record(folder.path(), Source::Port(link), SHORT, 1);
    let mut viewer = Viewer::connect(live.url());
    let source = synthetic(60).samples;
    viewer.find("samples", |_| true);
    wish(&mut viewer, "begin");
    // Numbers of the samples that a viewer was shown in the middle of a task.
    let mut seen = BTreeSet::new();
    let (mut lost, mut done) = (0, 0);
    let (mut in_task, mut held) = (false, false);
    // After the last cut the line stays whole and the session goes on.
    while board.cuts() < CUTS || done < 3 {
        let message = viewer.next().unwrap();
        match message["type"].as_str().unwrap() {
            "source" if message["connected"] == false => {
                let detail = message["detail"]["text"].as_str().unwrap_or_default();
                lost += usize::from(detail.contains("looking for it again"));
                in_task = false;
            }
            "session" => {
                in_task = message["phase"] == "cued";
                held = message["phase"] == "held";
                done = message["done"].as_u64().unwrap();
            }
            // The traces move again: a person presses the key until the session goes on.
            "samples" if held => wish(&mut viewer, "begin"),
            "samples" if in_task => {
                let first = message["first"].as_u64().unwrap() as usize;
                let shown = message["emg"].as_array().unwrap();
                for (number, shown) in (first..).zip(shown) {
                    let expected = serde_json::to_value(source[number % source.len()]).unwrap();
                    assert_eq!(*shown, expected, "sample {number}");
                    seen.insert(number);
                }
            }
            _ => {}
        }
    }
    assert!(lost > CUTS / 2, "{lost}: the page was not told");
    wish(&mut viewer, "finish");
    viewer.find("kept", |_| true);
    live.stop().unwrap();
    let files = recorded(folder.path());
    assert_equal(&files, &source);
    let kept: BTreeSet<usize> = files.iter().flat_map(|file| file.keys().copied()).collect();
    let missing = seen.difference(&kept).count();
    assert!(seen.len() > 2000, "{}", seen.len());
    assert_eq!(missing, 0, "of {} samples shown in a task", seen.len());
}
