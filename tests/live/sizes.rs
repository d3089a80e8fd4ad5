//! Page in windows of all sizes: label and cue are in view, nothing is wider than the window, no card is half empty.

use myointent::live::Source;

use super::browser::{Browser, FITS, VALID};
use super::record::{SHORT, phase, pictures, record};
use super::serve;

/// Name, width and height of each window; the zoomed ones are 1440 x 900 and 1366 x 768 at 200 %.
pub const WINDOWS: [(&str, u32, u32); 7] = [
    ("1366", 1366, 768),
    ("1440", 1440, 900),
    ("2560", 2560, 1440),
    ("phone", 390, 844),
    ("landscape", 844, 390),
    ("zoomed", 720, 450),
    ("zoomed-small", 683, 384),
];

/// Ids of those elements that are not in view as a whole.
fn hidden(browser: &mut Browser, ids: &[&str]) -> String {
    let ids = ids.join("','");
    let expression = format!(
        "['{ids}'].filter((id) => {{ const box = document.getElementById(id).getBoundingClientRect(); \
         return !(box.height > 0 && box.top >= 0 && box.bottom <= innerHeight && box.left >= 0 && box.right <= innerWidth); }}).join()"
    );
    browser.value(&expression).as_str().unwrap().to_owned()
}

/// Cards whose lowest content ends far above their lower edge.
const HALF_EMPTY: &str = "[...document.querySelectorAll('main section, main .lead > *')].filter((card) => card.checkVisibility() && card.id !== 'result') \
    .filter((card) => { const inner = [...card.querySelectorAll('*')].filter((one) => one.checkVisibility() && !one.closest('.unseen')); \
        const lowest = Math.max(...inner.map((one) => one.getBoundingClientRect().bottom)); \
        return card.getBoundingClientRect().bottom - lowest > 60; }).map((card) => card.className).join()";

/// Distances of the header's content and the cards' from the edges of the window, left and right.
const EDGES: &str = "(() => { const edge = (first, last) => [first.getBoundingClientRect().left, innerWidth - last.getBoundingClientRect().right].map(Math.round).join(); \
    const head = edge(document.querySelector('h1'), document.querySelector('header > .page')); \
    const cards = document.querySelectorAll('main > *'); \
    const shown = [...cards].filter((card) => card.checkVisibility()); \
    const left = Math.min(...shown.map((card) => card.getBoundingClientRect().left)); \
    const right = Math.min(...shown.map((card) => innerWidth - card.getBoundingClientRect().right)); \
    return head === [left, right].map(Math.round).join(); })()";

/// Ids of the elements that every window must show and this one does not.
const LOST: &str = "['mark', 'save', 'letters', 'valid', 'share', 'legend', 'notice'].filter((id) => !document.getElementById(id).checkVisibility()).join() + \
    ($traces.clientHeight > 340 ? '' : 'scores')";

/// Checks a window in which these elements have to be in view.
fn check(browser: &mut Browser, name: &str, ids: &[&str]) {
    browser.frames(20);
    browser.screenshot(&pictures().join(format!("{name}.png")));
    assert_eq!(hidden(browser, ids), "", "{name}");
    assert!(browser.is(FITS), "{name}");
    assert_eq!(browser.value(HALF_EMPTY), "", "{name}");
}

#[test]
fn label_and_cue_are_in_view_in_windows_of_all_sizes() {
    let (mut browser, live) = open!(serve(Source::Demo));
    for (name, width, height) in WINDOWS {
        browser.look(width, height, "light", "no-preference");
        browser.open(live.url());
        browser.wait_for(&format!("{VALID} && !$truth.hidden && !$share.hidden"));
        let ids = ["label", "truth", "agrees", "traces"];
        let shown = ids.len() - usize::from(name == "phone" || height < 560);
        check(&mut browser, &format!("size-{name}"), &ids[..shown]);
        assert!(width <= 860 || browser.is(EDGES), "{name}");
        // However large the letters are, nothing is lost (WCAG 1.4.4).
        assert_eq!(browser.value(LOST), "", "{name}");
    }
    live.stop().unwrap();
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
        check(
            &mut browser,
            &format!("session-{name}"),
            &["task", "label", "agrees"],
        );
    }
    live.stop().unwrap();
}
