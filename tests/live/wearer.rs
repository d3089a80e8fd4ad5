//! View for the person who wears the armband: one word, the hand as labelled, what to do now, all on one screen.

use myointent::live::Source;

use super::browser::VALID;
use super::record::{phase, pictures, record, short_with_point};
use super::serve;
use super::sizes::WINDOWS;

/// The parts of the view that are not in view as a whole, or cover each other.
pub const HIDDEN: &str = "(() => { const ids = ['worn-do', 'worn-hand', 'worn-word', 'worn-sign', 'worn-back', 'drawn']; \
    const boxes = ids.map((id) => [id, document.getElementById(id).getBoundingClientRect()]); \
    const outside = boxes.filter(([, box]) => !(box.height > 0 && box.top >= 0 && box.bottom <= innerHeight && box.left >= 0 && box.right <= innerWidth)); \
    const covered = boxes.filter(([, one], at) => boxes.slice(at + 1).some(([, other]) => \
        one.left < other.right - 1 && other.left < one.right - 1 && one.top < other.bottom - 1 && other.top < one.bottom - 1)); \
    return [...outside, ...covered].map(([id]) => id).join(); })()";

/// Whether no more of the hand's picture is shown than its square: the arm has no end.
const SQUARE: &str = "(() => { const { width, height } = $worn-hand.getBoundingClientRect(); \
    return Math.abs(width - height) < 2; })()";

const SCROLLS: &str = "document.documentElement.scrollHeight > innerHeight || document.documentElement.scrollWidth > innerWidth";

#[test]
fn the_wearer_sees_word_hand_and_task_on_one_screen_of_any_size() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    browser.press("w");
    browser.wait_for("document.body.dataset.view === 'wearer'");
    browser.wait_for("$worn-sign.dataset.state === 'right'");
    let schemes = ["light", "dark"].into_iter().cycle();
    for ((name, width, height), scheme) in WINDOWS.into_iter().zip(schemes) {
        browser.look(width, height, scheme, "reduce");
        browser.frames(3);
        assert_eq!(browser.value(HIDDEN), "", "{name}");
        assert_eq!(browser.value(SCROLLS), false, "{name}");
        assert!(browser.is(SQUARE), "{name}");
        browser.screenshot(&pictures().join(format!("wearer-{name}-{scheme}.png")));
    }
    // Word and hand are of the label, the task is the cue in words; a sign besides the colour says whether they agree.
    for class in ["open", "close", "relax"] {
        let hand = format!("$worn-hand.dataset.gesture === '{class}'");
        browser.wait_for(&format!("{hand} && $worn-word.textContent === '{class}'"));
    }
    let right = "$worn-sign.textContent.startsWith('✓')";
    browser.wait_for(&format!(
        "{right} && $worn-do.textContent === 'Make a fist'"
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
fn in_a_session_the_wearer_sees_what_is_asked_for_and_no_verdict_of_movement_that_means_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (mut browser, live) = open!(record(folder.path(), Source::Demo, &short_with_point(), 2));
    browser.look(1366, 768, "light", "no-preference");
    browser.wait_for(&format!("{} && {VALID}", phase("waiting")));
    browser.press("Enter");
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
    assert_eq!(browser.value(HIDDEN), "");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
