//! The page in a browser: it loads, moves, follows the recording, pauses, saves, and says when the stream is gone.

use std::path::Path;

use myointent::live::Source;
use recordings::{LoadOptions, load_bytes};

use super::browser::{CATCH, LOST, VALID};
use super::record::pictures;
use super::{serve, synthetic};

/// Script whose value changes with every change of the picture.
pub const PICTURE: &str = "$traces.toDataURL().split('').reduce((sum, letter) => (sum * 31 + letter.charCodeAt(0)) | 0, 7)";

#[test]
fn the_page_follows_a_recording_and_saves_what_it_saw() {
    let recording = synthetic(60);
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(recording.clone()))));
    browser.wait_for(VALID);
    browser.value(CATCH);

    // Traces move, and the label becomes what the recording says it is, and something else again.
    let before = browser.value(PICTURE);
    browser.wait_for(&format!("{PICTURE} !== {before}"));
    for class in ["open", "close", "relax"] {
        browser.wait_for(&format!("$label.textContent === '{class}'"));
    }
    browser.wait_for("Number($rate.textContent) > 190");
    let delay = browser.text("delay");
    let delay: u32 = delay.strip_suffix(" ms").unwrap().parse().unwrap();
    assert!((5..=255).contains(&delay), "{delay} ms");
    assert_eq!(browser.text("lost"), "0");

    // Paused, the picture stands, a key moves it, and the stream goes on behind it.
    browser.press(" ");
    assert_eq!(browser.value("$pause.ariaPressed"), "true");
    // The picture stops once the labels have come that are later by their look-ahead.
    browser.wait_for(&format!(
        "(async () => {{ const before = {PICTURE}; \
         for (let frame = 0; frame < 20; frame++) await new Promise(requestAnimationFrame); \
         return {PICTURE} === before; }})()"
    ));
    let paused = browser.value(PICTURE);
    browser.press("ArrowLeft");
    browser.wait_for(&format!("{PICTURE} !== {paused}"));
    browser.press(" ");
    assert_eq!(browser.value("$pause.ariaPressed"), "false");

    browser.press("m");
    browser.frames(20);
    browser.press("s");
    browser.wait_for("Boolean(window.saved)");
    let text = browser.value("window.saved.text()");
    let text = text.as_str().unwrap();
    assert!(text.contains(",mark 1\n"), "no mark in the csv");
    let library = load_bytes(Path::new("a.csv"), text.as_bytes(), &LoadOptions::default());
    let found = &library.unwrap().recordings[0];
    let first = text.lines().nth(1).unwrap().split(',').nth(9).unwrap();
    let first: usize = first.parse().unwrap();
    let expected = first..(first + found.samples.len()).min(recording.samples.len());
    assert!(expected.len() > 1000, "{expected:?}");
    assert_eq!(
        found.samples[..expected.len()],
        recording.samples[expected.clone()]
    );
    assert_eq!(found.labels[..expected.len()], recording.labels[expected]);

    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    browser.wait_for(LOST);
    assert!(browser.text("source").contains("has ended"));
}

#[test]
fn an_electrode_without_contact_is_named_and_marked() {
    let mut recording = synthetic(60);
    for sample in &mut recording.samples {
        sample[2] = 0;
    }
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(recording))));
    browser.wait_for("$electrodes?.textContent === 'Electrode 3 has no contact.'");
    assert_eq!(
        browser.value("document.querySelectorAll('#armband .pod.fault').length"),
        1
    );
    browser.screenshot(&pictures().join("electrode.png"));
    live.stop().unwrap();
    browser.wait_for("$electrodes.textContent === ''");
    assert_eq!(browser.complaints, [""; 0]);
}
