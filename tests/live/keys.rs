//! Keys, and what stays on the page: nobody ends or misses a task by a slip, and nothing that is over is shown as new.

use myointent::live::Source;

use super::browser::{Browser, CONNECTED, VALID};
use super::record::{SHORT, phase, pictures, record, step};
use super::{serve, synthetic};

const ASKS: &str = "$ending?.open === true";

#[test]
fn in_a_session_space_has_the_task_wait_and_e_asks_first() {
    let folder = tempfile::tempdir().unwrap();
    let (mut browser, live) = open!(record(folder.path(), Source::Demo, SHORT, 1));
    browser.wait_for(&phase("waiting"));
    browser.wait_for(CONNECTED);
    // A picture that was frozen before moves again with the session.
    browser.press(" ");
    browser.press("Enter");
    browser.wait_for(&phase("ready"));
    let paused = "$pause.ariaPressed";
    browser.wait_for(&format!("{paused} === 'false'"));
    browser.press(" ");
    browser.wait_for(&phase("held"));
    assert_eq!(browser.value(paused), "false");
    browser.press(" ");
    browser.wait_for(&phase("ready"));

    // A slip: the session waits, and goes on.
    browser.press("e");
    browser.wait_for(ASKS);
    browser.wait_for(&phase("held"));
    assert!(browser.text("ending").contains("gestures are recorded"));
    browser.screenshot(&pictures().join("record-ending.png"));
    browser.press("m");
    browser.press("Escape");
    browser.wait_for(&phase("ready"));
    assert!(!browser.is(ASKS));
    browser.press("e");
    browser.wait_for(ASKS);
    browser.press("e");
    browser.wait_for(&phase("over"));
    assert!(!browser.is(ASKS));
    // What is not good enough is recorded again, before anything else.
    browser.wait_for("$again.classList.contains('main')");
    assert!(browser.is(&step("record", "now")));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}

#[test]
fn a_paused_page_shows_the_label_and_cue_of_where_it_is() {
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(synthetic(60)))));
    // A gesture, and rest before it.
    browser.wait_for(&format!("{VALID} && $label.textContent === 'relax'"));
    browser.wait_for("$label?.textContent !== 'relax'");
    browser.press(" ");
    let mut shown = |key: &str| {
        browser.press(key);
        browser.frames(2);
        [browser.text("label"), browser.text("truth")]
    };
    let mut labels = vec![shown("Shift")];
    labels.extend((0..5).map(|_| shown("ArrowLeft")));
    assert!(
        labels.iter().any(|[label, _]| label == "relax"),
        "{labels:?}"
    );
    assert!(
        labels.iter().any(|[_, cue]| *cue != labels[0][1]),
        "{labels:?}"
    );
    let back: Vec<_> = (0..5).map(|_| shown("ArrowRight")).collect();
    assert!(labels.iter().rev().skip(1).eq(&back), "{labels:?} {back:?}");
    live.stop().unwrap();
}

#[test]
fn keys_of_one_letter_and_the_right_hand_can_be_switched_off_and_a_notice_passes() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    let pressed = |browser: &mut Browser| {
        browser.press("w");
        browser.value("location.hash")
    };
    assert_eq!(pressed(&mut browser), "#wearer");
    assert_eq!(pressed(&mut browser), "");
    browser.value("$letters.click(), $drawn.click()");
    assert_eq!(pressed(&mut browser), "");
    // The page keeps them.
    browser.open(live.url());
    browser.wait_for(VALID);
    assert_eq!(pressed(&mut browser), "");
    browser.value("$letters.click()");
    assert_eq!(pressed(&mut browser), "#wearer");
    browser.wait_for(
        "getComputedStyle(document.querySelector('#worn .hand')).transform === 'matrix(-1, 0, 0, 1, 0, 0)'",
    );

    browser.press("s");
    browser.wait_for("$notice.textContent.startsWith('saved')");
    browser.frames(60);
    // Nobody takes it for a person's.
    assert!(browser.text("notice").contains(": simulated_"));
    browser.wait_for("$notice.textContent === ''");
    live.stop().unwrap();
}

/// Whether the left fifth of the picture of the first electrode has a line.
const IS_FULL: &str = "(() => { const c = $traces; if (!c) return false; const left = 60; \
    const dots = c.getContext('2d').getImageData(left, 4, (c.width - left) / 5, 40).data; \
    const [r, g, b] = [0x1f, 0x5f, 0x8b]; let found = 0; \
    for (let at = 0; at < dots.length; at += 4) { \
        found += Math.abs(dots[at] - r) + Math.abs(dots[at + 1] - g) + Math.abs(dots[at + 2] - b) < 90 ? 1 : 0; } \
    return found > 20; })()";

#[test]
fn a_page_that_is_loaded_again_shows_the_last_seconds_at_once() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(IS_FULL);
    browser.open(live.url());
    browser.wait_for(CONNECTED);
    browser.frames(10);
    assert!(browser.is(IS_FULL));
    assert_ne!(browser.text("label"), "–");
    browser.screenshot(&pictures().join("loaded-again.png"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
