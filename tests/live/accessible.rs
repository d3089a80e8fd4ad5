//! Page for people who hear it, see it badly, or cannot bear motion.

use std::process::Command;

use myointent::live::Source;

use super::browser::VALID;
use super::record::{SHORT, record};
use super::serve;

/// Controls smaller than 24 px, by id or text (WCAG 2.2, target size).
const SMALL: &str = "[...document.querySelectorAll('button, summary, a, input')].filter((one) => one.checkVisibility()) \
    .filter((one) => { const { width, height } = one.getBoundingClientRect(); return width < 24 || height < 24; }) \
    .map((one) => one.id || one.textContent).join()";

/// Controls without a name.
const NAMELESS: &str = "[...document.querySelectorAll('button, summary, canvas, svg[role], progress, [role=toolbar], dialog')] \
    .filter((one) => !(one.ariaLabel || one.textContent.trim() || one.getAttribute('aria-labelledby'))).map((one) => one.outerHTML).join()";

/// Live regions that interrupt the reader, but for errors.
const LOUD: &str = "[...document.querySelectorAll('[aria-live=assertive], [role=alert]')].filter((one) => one.id !== 'trouble').map((one) => one.id).join()";

#[test]
fn controls_have_names_and_sizes_and_no_region_interrupts_a_reader() {
    let mut browser = start!();
    let folder = tempfile::tempdir().unwrap();
    for live in [
        serve(Source::Demo),
        record(folder.path(), Source::Demo, SHORT, 1),
    ] {
        browser.open(live.url());
        for (width, height) in [(1440, 900), (390, 844), (844, 390)] {
            browser.look(width, height, "light", "no-preference");
            browser.wait_for(VALID);
            browser.frames(3);
            for rule in [SMALL, NAMELESS, LOUD] {
                assert_eq!(browser.value(rule), "", "{width}: {rule}");
            }
        }
        live.stop().unwrap();
    }
}

#[test]
fn a_screen_reader_hears_label_and_cue_and_not_every_tenth_of_a_second() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    browser.wait_for("/^asked: \\w+; label: \\w+/.test($spoken.textContent)");
    assert!(browser.is("$spoken.getAttribute('role') === 'status'"));
    assert!(browser.is("$label.closest('[role=status], [aria-live]') === null"));
    // Seven seconds in which the label changes several times.
    let changes = browser.value(
        "new Promise((done) => { let count = 0; \
         new MutationObserver(() => { count += 1; }).observe($spoken, { childList: true, characterData: true, subtree: true }); \
         setTimeout(() => done(count), 7000); })",
    );
    assert!(changes.as_u64().unwrap() <= 4, "{changes}");
    live.stop().unwrap();
}

#[test]
fn without_motion_two_pictures_300_ms_apart_are_equal() {
    let mut browser = start!();
    let live = serve(Source::Demo);
    browser.look(1440, 900, "light", "reduce");
    browser.open(live.url());
    browser.wait_for(VALID);
    // A second step between the two is allowed, but not in most of the pairs.
    let equal = browser.value(
        "(async () => { let equal = 0; \
         const picture = () => $traces.toDataURL() + $armband.innerHTML; \
         for (let pair = 0; pair < 10; pair += 1) { const before = picture(); \
           await new Promise((done) => setTimeout(done, 300)); equal += picture() === before ? 1 : 0; } \
         return equal; })()",
    );
    assert!(equal.as_u64().unwrap() >= 4, "{equal} of 10");
    live.stop().unwrap();
}

#[test]
fn axe_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let npm = Command::new("npm")
        .args(["install", "--no-audit", "--no-fund", "axe-core@4.14.1"])
        .arg("--prefix")
        .arg(folder.path())
        .status();
    if !npm.is_ok_and(|status| status.success()) {
        myointent_tests::skip("npm cannot install axe-core");
        return;
    }
    let mut browser = start!();
    let axe = folder.path().join("node_modules/axe-core/axe.min.js");
    let axe = std::fs::read_to_string(axe).unwrap();
    let findings = "axe.run().then(({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`).join('\\n'))";
    let sessions = tempfile::tempdir().unwrap();
    for live in [
        serve(Source::Demo),
        record(sessions.path(), Source::Demo, SHORT, 1),
        serve(Source::Port(folder.path().join("board"))),
    ] {
        for scheme in ["light", "dark"] {
            browser.look(1440, 900, scheme, "reduce");
            browser.open(live.url());
            browser.wait_for(&format!("$empty?.hidden === false || {VALID}"));
            browser.run(&axe);
            assert_eq!(browser.value(findings), "", "{scheme} {}", live.url());
            browser.value("location.hash = 'wearer'");
            assert_eq!(browser.value(findings), "", "{scheme}, the wearer's view");
            browser.open(&format!("{}sessions", live.url()));
            browser.wait_for("/[^…]$/.test($state?.textContent ?? '')");
            browser.run(&axe);
            assert_eq!(browser.value(findings), "", "{scheme}, the record");
        }
        live.stop().unwrap();
    }
}
