//! Board on a pseudo-terminal: connected, damaged, lost and back.

use myointent::live::{self, Live, Options, Source};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::board::{Board, Damage};
use super::viewer::Viewer;
use super::{shipped, synthetic};

fn serve(port: &Path, model: Option<Vec<u8>>) -> Live {
    live::start(Options {
        source: Source::Port(port.to_owned()),
        model,
        listen: "127.0.0.1:0".parse().unwrap(),
        imu: false,
        record: None,
    })
    .unwrap()
}

/// Returns a path for a board's terminal.
fn link(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("board")
}

#[test]
fn a_board_is_asked_what_it_is_and_shown_with_samples_labels_and_scores() {
    let folder = tempfile::tempdir().unwrap();
    let board = Board::start(&link(&folder), Damage::None);
    let live = serve(&link(&folder), Some(shipped()));
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
fn a_board_that_is_lost_is_found_again_and_viewers_are_told_both() {
    let folder = tempfile::tempdir().unwrap();
    let live = serve(&link(&folder), None);
    let mut viewer = Viewer::connect(live.url());
    let source = viewer.find("source", |source| source["connected"] == false);
    let detail = source["detail"].as_str().unwrap();
    assert!(detail.contains("looking for it again"), "{detail}");
    let mut random = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..10 {
        let board = Board::start(&link(&folder), Damage::None);
        viewer.find("source", |source| source["connected"] == true);
        viewer.find("samples", |_| true);
        // The cut falls at any moment of the dialogue.
        std::thread::sleep(Duration::from_micros(random.random_range(0..100_000)));
        drop(board);
        let source = viewer.find("source", |source| source["connected"] == false);
        let detail = source["detail"].as_str().unwrap();
        assert!(detail.contains("looking for it again"), "{detail}");
    }
    live.stop().unwrap();
}

#[test]
fn a_damaged_line_shows_no_wrong_sample_and_its_losses_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let board = Board::start(&link(&folder), Damage::CutsAndGarbage(7));
    let live = serve(&link(&folder), Some(shipped()));
    let mut viewer = Viewer::connect(live.url());
    let recording = synthetic(60).samples;
    let (mut seen, mut next, mut gaps) = (0, None, 0);
    while seen < 1200 {
        let message = viewer.next().unwrap();
        if message["type"] != "samples" {
            continue;
        }
        let first = message["first"].as_u64().unwrap();
        let expected = &recording[first as usize..][..2];
        assert_eq!(message["emg"], serde_json::to_value(expected).unwrap());
        gaps += first - next.unwrap_or(first);
        next = Some(first + 2);
        seen += 2;
    }
    assert!(gaps > 60, "{gaps}: nothing was cut");
    let line = viewer.find("line", |line| line["samples"].as_u64().unwrap() >= gaps);
    assert!(line["damaged"].as_u64().unwrap() > 3, "{line}");
    live.stop().unwrap();
    drop(board);
}
