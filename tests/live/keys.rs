//! Keys, and what stays on the page: nobody ends or misses a task by a slip, and nothing that is over is shown as new.

use myointent::live::Source;

use super::browser::Browser;
use super::record::{SHORT, pictures, record, step};
use super::{demo_page, serve, synthetic};

/// Whether a phase of the session is shown.
fn phase(name: &str) -> String {
    format!("document.getElementById('session')?.dataset.phase === '{name}'")
}

const ASKS: &str = "document.getElementById('ending')?.open === true";

#[test]
fn in_a_session_space_has_the_task_wait_and_e_asks_first() {
    let name = "in_a_session_space_has_the_task_wait_and_e_asks_first";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, SHORT, 1);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(&phase("waiting"));
    browser.wait_for("document.getElementById('source').dataset.state === 'connected'");
    // A picture that was frozen before moves again with the session.
    browser.press(" ");
    browser.press("Enter");
    browser.wait_for(&phase("ready"));
    let paused = "document.getElementById('pause').ariaPressed";
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
    assert_eq!(browser.value(ASKS), false);
    browser.press("e");
    browser.wait_for(ASKS);
    browser.press("e");
    browser.wait_for(&phase("over"));
    assert_eq!(browser.value(ASKS), false);
    // What is not good enough is recorded again, before anything else.
    browser.wait_for("document.getElementById('again').classList.contains('main')");
    assert_eq!(browser.value(&step("record", "now")), true);
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}

#[test]
fn a_paused_page_shows_the_label_and_cue_of_where_it_is() {
    let name = "a_paused_page_shows_the_label_and_cue_of_where_it_is";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let live = serve(Source::Replay(Box::new(synthetic(60))));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    // A gesture, and rest before it.
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes' && document.getElementById('label').textContent === 'relax'");
    browser.wait_for("document.getElementById('label')?.textContent !== 'relax'");
    browser.press(" ");
    let shown = |browser: &mut Browser| {
        browser.frames(2);
        (
            browser.text("label"),
            browser.value("document.getElementById('truth').lastChild.textContent"),
        )
    };
    let mut labels = vec![shown(&mut browser)];
    for _ in 0..5 {
        browser.press("ArrowLeft");
        labels.push(shown(&mut browser));
    }
    assert!(
        labels.iter().any(|(label, _)| label == "relax"),
        "{labels:?}"
    );
    assert!(
        labels.iter().any(|(_, cue)| cue != &labels[0].1),
        "{labels:?}"
    );
    let back: Vec<_> = (0..5)
        .map(|_| {
            browser.press("ArrowRight");
            shown(&mut browser)
        })
        .collect();
    assert!(labels.iter().rev().skip(1).eq(&back), "{labels:?} {back:?}");
    live.stop().unwrap();
}

#[test]
fn keys_of_one_letter_can_be_switched_off() {
    let name = "keys_of_one_letter_can_be_switched_off";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    let pressed = |browser: &mut Browser, key: &str| {
        browser.press(key);
        browser.value("location.hash")
    };
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes'");
    assert_eq!(pressed(&mut browser, "w"), "#wearer");
    assert_eq!(pressed(&mut browser, "w"), "");
    browser.value("document.getElementById('letters').click()");
    assert_eq!(pressed(&mut browser, "w"), "");
    // The page keeps it.
    browser.open(live.url());
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes'");
    assert_eq!(pressed(&mut browser, "w"), "");
    browser.value("document.getElementById('letters').click()");
    assert_eq!(pressed(&mut browser, "w"), "#wearer");
    live.stop().unwrap();
}

#[test]
fn that_something_was_saved_is_not_said_for_ever() {
    let name = "that_something_was_saved_is_not_said_for_ever";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes'");
    browser.press("s");
    browser.wait_for("document.getElementById('notice').textContent.startsWith('saved')");
    browser.frames(60);
    // Nobody takes it for a person's.
    assert!(browser.text("notice").contains(": simulated_"));
    browser.wait_for("document.getElementById('notice').textContent === ''");
    live.stop().unwrap();
}

/// Whether the left fifth of the picture of the first electrode has a line.
const IS_FULL: &str = "(() => { const c = document.getElementById('traces'); if (!c) return false; const left = 60; \
    const dots = c.getContext('2d').getImageData(left, 4, (c.width - left) / 5, 40).data; \
    const [r, g, b] = [0x1f, 0x5f, 0x8b]; let found = 0; \
    for (let at = 0; at < dots.length; at += 4) { \
        found += Math.abs(dots[at] - r) + Math.abs(dots[at + 1] - g) + Math.abs(dots[at + 2] - b) < 90 ? 1 : 0; } \
    return found > 20; })()";

#[test]
fn a_page_that_is_loaded_again_shows_the_last_seconds_at_once() {
    let name = "a_page_that_is_loaded_again_shows_the_last_seconds_at_once";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    browser.wait_for(IS_FULL);
    browser.open(live.url());
    browser.wait_for("document.getElementById('source')?.dataset.state === 'connected'");
    browser.frames(10);
    assert_eq!(browser.value(IS_FULL), true);
    assert_ne!(browser.text("label"), "–");
    browser.screenshot(&pictures().join("loaded-again.png"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
