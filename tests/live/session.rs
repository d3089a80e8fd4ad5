//! A session by keys, and what its wearer sees: nobody ends or misses a task by a slip.

use myointent::live::Source;

use super::browser::CONNECTED;
use super::record::{phase, pictures, record, short_with_point, step};
use super::sizes::UNWORN;

const ASKS: &str = "$ending?.open === true";

#[test]
fn a_session_waits_asks_before_it_ends_and_shows_its_wearer_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let protocol = short_with_point().replace("rounds = 2", "rounds = 8");
    let (mut browser, live) = open!(record(folder.path(), Source::Demo, &protocol, 2));
    browser.wait_for(&format!("{} && {CONNECTED}", phase("waiting")));
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

    // The wearer's view has no verdict of movement that means nothing.
    browser.press("w");
    let shows = |class: &str, sign: &str| {
        format!(
            "$worn-hand.dataset.gesture === '{class}' && \
             Number($worn-word.textContent) > 0 && \
             {sign}.test($worn-sign.textContent)"
        )
    };
    browser.wait_for(&shows("open", "/^✓ that is it · next: Let the hand hang/"));
    browser.wait_for(&shows("point", "/^next: Let the hand hang/"));
    browser.screenshot(&pictures().join("wearer-session.png"));
    assert_eq!(browser.value(UNWORN), "");
    browser.press("w");

    // A slip: the session waits, and goes on.
    browser.wait_for(&phase("cued"));
    browser.press("e");
    browser.wait_for(ASKS);
    browser.wait_for(&phase("held"));
    assert!(browser.text("ending").contains("Round 1 of 8, "));
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
