//! Page in windows of all sizes, and for all people: label and cue are in view, nothing is wider than the window, no card is half
//! empty, controls are large enough, no region interrupts a reader, and axe finds nothing.

use std::process::Command;

use myointent::live::Source;

use super::browser::{Browser, FITS, VALID};
use super::record::{SHORT, phase, pictures, record};
use super::serve;

/// Name, width and height of each window; the zoomed ones are 1440 x 900 and 1366 x 768 at 200 %.
const WINDOWS: [(&str, u32, u32); 8] = [
    ("1366", 1366, 768),
    ("1440", 1440, 900),
    ("2560", 2560, 1440),
    ("phone", 390, 844),
    ("small-phone", 320, 568),
    ("landscape", 844, 390),
    ("zoomed", 720, 450),
    ("zoomed-small", 683, 384),
];

/// Rules, each of which names what breaks it.
const RULES: [&str; 3] = [
    // Cards whose lowest content ends far above their lower edge.
    "[...document.querySelectorAll('main section, main .lead > *')].filter((card) => card.checkVisibility() && card.id !== 'result') \
     .filter((card) => { const inner = [...card.querySelectorAll('*')].filter((one) => one.checkVisibility() && !one.closest('.unseen')); \
         const lowest = Math.max(...inner.map((one) => one.getBoundingClientRect().bottom)); \
         return card.getBoundingClientRect().bottom - lowest > 60; }).map((card) => card.className).join()",
    // Controls smaller than 24 px (WCAG 2.2, target size).
    "[...document.querySelectorAll('button, summary, a, input')].filter((one) => one.checkVisibility()) \
     .filter((one) => { const { width, height } = one.getBoundingClientRect(); return width < 24 || height < 24; }) \
     .map((one) => one.id || one.textContent).join()",
    // Live regions that interrupt the reader, but for errors.
    "[...document.querySelectorAll('[aria-live=assertive], [role=alert]')].filter((one) => one.id !== 'trouble').map((one) => one.id).join()",
];

/// Ids of the elements that every window must show and this one does not.
const LOST: &str = "['mark', 'save', 'letters', 'valid', 'share', 'legend', 'notice'].filter((id) => !document.getElementById(id).checkVisibility()).join() + \
    ($traces.clientHeight > 340 ? '' : 'scores')";

/// The parts of the wearer's view that are not in view as a whole, or cover each other; a hand that is not square, whose arm would
/// have an end; and whether the view scrolls.
pub const UNWORN: &str = "(() => { const ids = ['worn-do', 'worn-hand', 'worn-word', 'worn-sign', 'worn-back', 'drawn']; \
    const boxes = ids.map((id) => [id, document.getElementById(id).getBoundingClientRect()]); \
    const outside = boxes.filter(([, box]) => !(box.height > 0 && box.top >= 0 && box.bottom <= innerHeight && box.left >= 0 && box.right <= innerWidth)); \
    const covered = boxes.filter(([, one], at) => boxes.slice(at + 1).some(([, other]) => \
        one.left < other.right - 1 && other.left < one.right - 1 && one.top < other.bottom - 1 && other.top < one.bottom - 1)); \
    const { width, height } = $worn-hand.getBoundingClientRect(); \
    const { scrollHeight, scrollWidth } = document.documentElement; \
    return [...outside, ...covered].map(([id]) => id).join() + (Math.abs(width - height) < 2 ? '' : ' no square') \
        + (scrollHeight > innerHeight || scrollWidth > innerWidth ? ' scrolls' : ''); })()";

/// Checks a window in which these elements have to be in view.
fn check(browser: &mut Browser, name: &str, ids: &[&str]) {
    browser.frames(20);
    browser.screenshot(&pictures().join(format!("{name}.png")));
    let ids = ids.join("','");
    let hidden = format!(
        "['{ids}'].filter((id) => {{ const box = document.getElementById(id).getBoundingClientRect(); \
         return !(box.height > 0 && box.top >= 0 && box.bottom <= innerHeight && box.left >= 0 && box.right <= innerWidth); }}).join()"
    );
    assert_eq!(browser.value(&hidden), "", "{name}");
    assert!(browser.is(FITS), "{name}");
    for rule in RULES {
        assert_eq!(browser.value(rule), "", "{name}: {rule}");
    }
}

#[test]
fn label_cue_and_the_wearers_hand_are_in_view_in_windows_of_all_sizes() {
    let (mut browser, live) = open!(serve(Source::Demo));
    let schemes = ["light", "dark"].into_iter().cycle();
    for ((name, width, height), scheme) in WINDOWS.into_iter().zip(schemes) {
        browser.look(width, height, scheme, "no-preference");
        browser.open(live.url());
        browser.wait_for(&format!("{VALID} && !$truth.hidden && !$share.hidden"));
        let ids = ["label", "truth", "agrees", "traces"];
        let shown = ids.len() - usize::from(name.ends_with("phone") || height < 560);
        check(&mut browser, &format!("size-{name}"), &ids[..shown]);
        // However large the letters are, nothing is lost (WCAG 1.4.4).
        assert_eq!(browser.value(LOST), "", "{name}");
        browser.press("w");
        browser.wait_for("document.body.dataset.view === 'wearer'");
        browser.frames(3);
        assert_eq!(browser.value(UNWORN), "", "{name}");
        browser.screenshot(&pictures().join(format!("wearer-{name}-{scheme}.png")));
    }
    // Word and hand are of the cue, as is the task in words; a sign besides the colour says whether the label agrees, and which it is.
    for class in ["open", "close", "relax"] {
        let hand = format!("$worn-hand.dataset.gesture === '{class}'");
        browser.wait_for(&format!("{hand} && $worn-word.textContent === '{class}'"));
    }
    let right = "/^✓ that is it · seen: close$/.test($worn-sign.textContent)";
    browser.wait_for(&format!(
        "{right} && $worn-do.textContent === 'Close the hand to a fist'"
    ));
    // While the armband is aligned, that is what to do.
    browser.press("a");
    let opens = "$worn-do.textContent === 'Open the hand twice, with rest before and after'";
    browser.wait_for(opens);
    browser.press("a");
    browser.wait_for(&format!("!({opens})"));
    // A reader hears task and label politely, and nothing moves.
    for id in ["worn-do", "spoken"] {
        let heard = format!("${id}.checkVisibility() && ${id}.getAttribute('role')");
        assert_eq!(browser.value(&heard), "status");
    }
    browser.look(1440, 900, "light", "reduce");
    assert_eq!(browser.value("document.getAnimations().length"), 0);
    // By its address too, and back again.
    browser.press("w");
    browser.wait_for("document.body.dataset.view === 'all' && $traces.checkVisibility()");
    browser.open("about:blank");
    browser.open(&format!("{}#wearer", live.url()));
    browser.wait_for("$worn?.checkVisibility()");
    live.stop().unwrap();
    browser.wait_for("$worn.dataset.label === 'none'");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn task_and_label_are_in_view_in_a_session_in_windows_of_all_sizes() {
    let folder = tempfile::tempdir().unwrap();
    let protocol = SHORT.replace("rounds = 2", "rounds = 8");
    let (mut browser, live) = open!(record(folder.path(), Source::Demo, &protocol, 1));
    browser.wait_for(&format!("{} && {VALID}", phase("waiting")));
    browser.press("Enter");
    for (name, width, height) in WINDOWS {
        browser.look(width, height, "light", "no-preference");
        browser.wait_for(&phase("cued"));
        let ids = ["task", "label", "agrees"];
        check(&mut browser, &format!("session-{name}"), &ids);
    }
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
            // A task in progress, and the arm's card; without a stream there is no task.
            browser.value("$arm.hidden = false, $play.click()");
            browser.wait_for("$play.disabled || !$guide.hidden");
            assert_eq!(browser.value(findings), "", "{scheme}, box and blocks");
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
