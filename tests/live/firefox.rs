//! The page in Firefox: what a session, an alignment, the keys, the wearer's view and German need of a browser.

use myointent::live::Source;

use super::browser::{Browser, BrowserKind, FITS, VALID};
use super::page::PICTURE;
use super::record::{SHORT, phase, pictures, record};
use super::serve;
use super::wearer::HIDDEN;

#[test]
fn the_demo_moves_aligns_speaks_german_and_obeys_keys_in_firefox() {
    let Some(mut browser) = Browser::start(BrowserKind::Firefox) else {
        return;
    };
    let live = serve(Source::Demo);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(VALID);
    browser.wait_for("$agrees.dataset.state === 'right'");
    let picture = browser.value(PICTURE);
    browser.wait_for(&format!("{PICTURE} !== {picture}"));
    assert!(browser.is(FITS));
    browser.screenshot(&pictures().join("firefox.png"));

    browser.press(" ");
    browser.wait_for("$pause.ariaPressed === 'true'");
    browser.frames(20);
    let paused = browser.value(PICTURE);
    browser.press("ArrowLeft");
    browser.wait_for(&format!("{PICTURE} !== {paused}"));
    browser.press(" ");
    browser.wait_for("$pause.ariaPressed === 'false'");

    browser.press("a");
    browser.wait_for("$placement.textContent.startsWith('Aligned')");

    browser.press("w");
    browser.wait_for("$worn-sign.dataset.state === 'right'");
    assert_eq!(browser.value(HIDDEN), "");
    browser.screenshot(&pictures().join("firefox-wearer.png"));
    browser.press("w");
    browser.value("$language.click()");
    browser.wait_for(&format!(
        "document.documentElement?.lang === 'de' && {VALID}"
    ));
    browser.wait_for("$label.textContent === 'Faust'");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}

#[test]
fn a_session_is_led_and_kept_in_firefox() {
    let Some(mut browser) = Browser::start(BrowserKind::Firefox) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, SHORT, 2);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(&format!("{} && {VALID}", phase("waiting")));
    browser.press("Enter");
    let fist = "$task.textContent === 'Make a fist' && $label.textContent === 'close'";
    browser.wait_for(&format!("{fist} && $agrees.dataset.state === 'right'"));
    browser.screenshot(&pictures().join("firefox-session.png"));
    browser.press(" ");
    browser.wait_for(&phase("held"));
    browser.press("Enter");
    browser.wait_for(&phase("cued"));
    browser.press("e");
    browser.wait_for("$ending.open");
    browser.press("e");
    browser.wait_for("!$result.hidden");
    assert!(browser.text("verdict").starts_with("Not good enough"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
