//! The page in Firefox: what a session, an alignment, the keys, the wearer's view and German need of a browser.

use myointent::live::Source;

use super::browser::{Browser, BrowserKind, FITS, VALID};
use super::record::{SHORT, phase, record};
use super::replay::PICTURE;
use super::sizes::UNWORN;

#[test]
fn the_page_moves_aligns_leads_a_session_speaks_german_and_obeys_keys_in_firefox() {
    let Some(mut browser) = Browser::start(BrowserKind::Firefox) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, SHORT, 2);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(&format!("{} && {VALID}", phase("waiting")));
    let picture = browser.value(PICTURE);
    browser.wait_for(&format!("{PICTURE} !== {picture}"));
    assert!(browser.is(FITS));
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

    browser.press("Enter");
    let fist = "$task.textContent === 'Close the hand to a fist' && $label.textContent === 'close'";
    browser.wait_for(&format!("{fist} && $agrees.dataset.state === 'right'"));
    browser.press("w");
    browser.wait_for("document.body.dataset.view === 'wearer'");
    browser.frames(3);
    assert_eq!(browser.value(UNWORN), "");
    browser.press("w");
    browser.press(" ");
    browser.wait_for(&phase("held"));
    browser.press("Enter");
    browser.wait_for(&phase("cued"));
    browser.press("e");
    browser.wait_for("$ending.open");
    browser.press("e");
    browser.wait_for("!$result.hidden");
    assert!(browser.text("verdict").starts_with("Not good enough"));
    browser.value("$language.click()");
    let german = "document.documentElement?.lang === 'de'";
    browser.wait_for(&format!("{german} && $label.textContent === 'Ruhe'"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
