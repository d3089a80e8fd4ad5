//! The page of a simulated arm: plain words, keys, marks, what a screen reader hears, rest for the eyes, and German.

use myointent::live::Source;

use super::browser::{Browser, VALID};
use super::languages::{ENGLISH, GERMAN, UNEQUAL};
use super::record::pictures;
use super::serve;

/// Texts, widths and colours of the lines that the page draws into the picture from now on.
const WATCH: &str = "(() => { window.texts = new Set(); window.drawn = {}; \
    const { fillText, stroke } = CanvasRenderingContext2D.prototype; \
    CanvasRenderingContext2D.prototype.fillText = function (text, ...all) { window.texts.add(text); return fillText.call(this, text, ...all); }; \
    CanvasRenderingContext2D.prototype.stroke = function (...all) { \
        (window.drawn[this.strokeStyle] ??= new Set()).add(this.lineWidth); return stroke.apply(this, all); }; \
    return true; })()";

#[test]
fn the_page_of_a_simulated_arm_is_plain_heard_and_led_by_keys_and_german_if_asked() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    browser.value(WATCH);
    speaks_plainly(&mut browser);
    marks(&mut browser);
    is_heard(&mut browser);
    obeys_keys(&mut browser, live.url());
    stands_still(&mut browser);
    // By the switch, and kept.
    assert_eq!(browser.value(UNEQUAL), "");
    assert_eq!(browser.value("document.documentElement?.lang"), "en");
    browser.value("$language.click()");
    let german = format!("{GERMAN} && {VALID}");
    browser.wait_for(&german);
    browser.open(live.url());
    browser.wait_for(&format!("{german} && $label.textContent === 'Faust'"));
    browser.wait_for("!$share.hidden");
    assert_eq!(browser.value(ENGLISH), "");
    browser.screenshot(&pictures().join("german.png"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    browser.wait_for("$empty.hidden === false");
    assert_eq!(browser.value(ENGLISH), "");
}

/// Plain words, each with an explanation behind a "?", and numbers for those who open them.
fn speaks_plainly(browser: &mut Browser) {
    browser.press("a");
    browser.wait_for("$placement.textContent.startsWith('Aligned')");
    let seen = browser.value("document.body.innerText + [...window.texts].join(' ')");
    let seen = seen.as_str().unwrap().to_lowercase();
    let jargon = "valid,look-ahead,hold ,distance,margin,mirrored,not known,softmax";
    for jargon in jargon.split(',') {
        assert!(!seen.contains(jargon), "{jargon}: {seen}");
    }
    let helps = browser.value("document.querySelectorAll('main details.what').length");
    assert!(helps.as_u64().unwrap() >= 4, "{helps}");
    let named = "[...document.querySelectorAll('details.what summary')].every((one) => one.ariaLabel?.length > 10)";
    assert!(browser.is(named));
    let open = "document.querySelector('.placement details.what p').checkVisibility()";
    assert!(!browser.is(open));
    browser.value("document.querySelector('.placement details.what summary').click()");
    assert!(browser.is(open));
    let inside = "(() => { const { left, right, top, bottom } = document.querySelector('.placement details.what p').getBoundingClientRect(); \
        return left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight; })()";
    assert!(browser.is(inside), "an explanation outside the window");
    browser.press("Escape");
    assert!(!browser.is(open));
    let number = "$distance.checkVisibility()";
    assert!(!browser.is(number));
    browser.value("document.querySelector('#fit summary').click()");
    assert!(browser.is(number));
    assert!(browser.text("distance").parse::<f64>().is_ok());
}

/// A label that equals the cue is never called changing, other movement is drawn as strong as the classes, and where fewer than half of
/// the gestures are recognised there is advice.
fn marks(browser: &mut Browser) {
    let while_equal = "new Promise((done) => { const states = new Set(); const end = performance.now() + 6000; \
        const look = () => { const [label, asked] = ['#label', '#truth b'].map((name) => document.querySelector(name).textContent); \
            if (label === asked) states.add($agrees.dataset.state); \
            if (performance.now() < end) requestAnimationFrame(look); else done([...states].join()); }; look(); })";
    assert_eq!(browser.value(while_equal), "right");
    for name in ["open", "other"] {
        let colour = "getComputedStyle(document.documentElement).getPropertyValue";
        let width = format!("Math.max(...window.drawn[{colour}('--{name}').trim()])");
        assert_eq!(browser.value(&width), 2, "{name}");
    }
    for (right, all, is_low) in [(14, 30, true), (15, 30, false), (14, 29, false)] {
        let share = format!(
            "import('./now.js').then(({{ Now }}) => {{ new Now().share({{ gestures: [{right}, {all}], rest: [0, 0], other: [0, 0] }}); return $low.checkVisibility(); }})"
        );
        assert_eq!(browser.value(&share), is_low, "{right} of {all}");
    }
}

/// A screen reader hears label and cue, and not every tenth of a second.
fn is_heard(browser: &mut Browser) {
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
}

/// Keys of one letter and the right hand can be switched off, which the page keeps; and a notice passes.
fn obeys_keys(browser: &mut Browser, url: &str) {
    let pressed = |browser: &mut Browser| {
        browser.press("w");
        browser.value("location.hash")
    };
    assert_eq!(pressed(browser), "#wearer");
    assert_eq!(pressed(browser), "");
    browser.value("$letters.click(), $drawn.click()");
    browser.open(url);
    browser.wait_for(VALID);
    assert_eq!(pressed(browser), "");
    browser.value("$letters.click()");
    assert_eq!(pressed(browser), "#wearer");
    browser
        .wait_for("getComputedStyle(document.querySelector('#worn .hand')).transform === 'none'");
    assert_eq!(pressed(browser), "");
    browser.press("s");
    browser.wait_for("$notice.textContent.startsWith('saved')");
    browser.frames(60);
    // Nobody takes it for a person's.
    assert!(browser.text("notice").contains(": simulated_"));
    browser.wait_for("$notice.textContent === ''");
}

/// Without motion, two pictures 300 ms apart are equal. A second step between the two is allowed, but not in most of the pairs.
fn stands_still(browser: &mut Browser) {
    browser.look(1440, 900, "light", "reduce");
    let equal = browser.value(
        "(async () => { let equal = 0; \
         const picture = () => $traces.toDataURL() + $armband.innerHTML; \
         for (let pair = 0; pair < 10; pair += 1) { const before = picture(); \
           await new Promise((done) => setTimeout(done, 300)); equal += picture() === before ? 1 : 0; } \
         return equal; })()",
    );
    assert!(equal.as_u64().unwrap() >= 4, "{equal} of 10");
}
