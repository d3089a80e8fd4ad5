//! View for the person who wears the armband: one word, the hand as labelled, what to do now, all on one screen.

use myointent::live::Source;

use super::browser::Browser;
use super::demo_page;
use super::page::VALID;
use super::record::{pictures, record, short_with_point};
use super::sizes::WINDOWS;

/// The parts of the view that are not in view as a whole, or cover each other.
pub const HIDDEN: &str = "(() => { const ids = ['worn-do', 'worn-hand', 'worn-word', 'worn-sign', 'worn-back']; \
    const boxes = ids.map((id) => [id, document.getElementById(id).getBoundingClientRect()]); \
    const outside = boxes.filter(([, box]) => !(box.height > 0 && box.top >= 0 && box.bottom <= innerHeight && box.left >= 0 && box.right <= innerWidth)); \
    const covered = boxes.filter(([, one], at) => boxes.slice(at + 1).some(([, other]) => \
        one.left < other.right - 1 && other.left < one.right - 1 && one.top < other.bottom - 1 && other.top < one.bottom - 1)); \
    return [...outside, ...covered].map(([id]) => id).join(); })()";

/// Whether no more of the hand's picture is shown than its square: the arm has no end.
const SQUARE: &str = "(() => { const { width, height } = document.getElementById('worn-hand').getBoundingClientRect(); \
    return Math.abs(width - height) < 2; })()";

const SCROLLS: &str = "document.documentElement.scrollHeight > innerHeight || document.documentElement.scrollWidth > innerWidth";

#[test]
fn the_wearer_sees_word_hand_and_task_on_one_screen_of_any_size() {
    let name = "the_wearer_sees_word_hand_and_task_on_one_screen_of_any_size";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    browser.wait_for(VALID);
    browser.press("w");
    browser.wait_for("document.body.dataset.view === 'wearer'");
    browser.wait_for("document.getElementById('worn-sign').dataset.state === 'right'");
    let schemes = ["light", "dark"].into_iter().cycle();
    for ((name, width, height), scheme) in WINDOWS.into_iter().zip(schemes) {
        browser.look(width, height, scheme, "reduce");
        browser.frames(3);
        assert_eq!(browser.value(HIDDEN), "", "{name}");
        assert_eq!(browser.value(SCROLLS), false, "{name}");
        assert_eq!(browser.value(SQUARE), true, "{name}");
        browser.screenshot(&pictures().join(format!("wearer-{name}-{scheme}.png")));
    }
    // Word and hand are of the label, the task is the cue in words; a sign besides the colour says whether they agree.
    for class in ["open", "close", "relax"] {
        browser.wait_for(&format!(
            "document.getElementById('worn-word').textContent === '{class}' && \
             document.getElementById('worn-hand').dataset.gesture === '{class}'"
        ));
    }
    browser.wait_for(
        "document.getElementById('worn-do').textContent === 'Make a fist' && \
                      document.getElementById('worn-sign').textContent.startsWith('✓')",
    );
    // While the armband is aligned, that is what to do.
    browser.press("a");
    browser.wait_for(
        "document.getElementById('worn-do').textContent === 'Open the hand twice, with rest before and after'",
    );
    browser.press("a");
    browser.wait_for("document.getElementById('worn-do').textContent !== 'Open the hand twice, with rest before and after'");
    // A reader hears task and label politely, and nothing moves.
    for id in ["worn-do", "spoken"] {
        let heard = format!(
            "document.getElementById('{id}').checkVisibility() && document.getElementById('{id}').getAttribute('role')"
        );
        assert_eq!(browser.value(&heard), "status");
    }
    assert_eq!(browser.value("document.getAnimations().length"), 0);
    // By its address too, and back again.
    browser.press("w");
    browser.wait_for("document.body.dataset.view === 'all' && document.getElementById('traces').checkVisibility()");
    browser.open("about:blank");
    browser.open(&format!("{}#wearer", live.url()));
    browser.wait_for("document.getElementById('worn')?.checkVisibility()");
    live.stop().unwrap();
    browser.wait_for("document.getElementById('worn').dataset.label === 'none'");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn in_a_session_the_wearer_sees_what_is_asked_for_and_no_verdict_of_movement_that_means_nothing() {
    let name = "in_a_session_the_wearer_sees_what_is_asked_for_and_no_verdict_of_movement_that_means_nothing";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, &short_with_point(), 2);
    browser.look(1366, 768, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(
        "document.getElementById('session')?.dataset.phase === 'waiting' && \
         document.getElementById('valid').dataset.valid === 'yes'",
    );
    browser.press("Enter");
    browser.press("w");
    let shows = |class: &str, sign: &str| {
        format!(
            "document.getElementById('worn-hand').dataset.gesture === '{class}' && \
             Number(document.getElementById('worn-word').textContent) > 0 && \
             {sign}.test(document.getElementById('worn-sign').textContent)"
        )
    };
    browser.wait_for(&shows("open", "/^✓ that is it · next: Let the hand hang/"));
    browser.wait_for(&shows("point", "/^next: Let the hand hang/"));
    browser.screenshot(&pictures().join("wearer-session.png"));
    assert_eq!(browser.value(HIDDEN), "");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
