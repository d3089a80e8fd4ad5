//! Words of the page: plain, each with an explanation behind a "?", and numbers for those who open them.

use myointent::live::Source;

use super::browser::VALID;
use super::record::pictures;
use super::serve;

/// Texts that the page draws into the picture from now on.
const WATCH_TEXTS: &str = "(() => { window.texts = new Set(); \
    const fill = CanvasRenderingContext2D.prototype.fillText; \
    CanvasRenderingContext2D.prototype.fillText = function (text, ...all) { window.texts.add(text); return fill.call(this, text, ...all); }; \
    return true; })()";

#[test]
fn the_page_speaks_plainly_and_explains_itself_by_mouse_and_keys() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    browser.value(WATCH_TEXTS);
    browser.press("a");
    browser.wait_for("$placement.textContent.startsWith('Aligned')");
    let seen = browser.value("document.body.innerText + [...window.texts].join(' ')");
    let seen = seen.as_str().unwrap().to_lowercase();
    let jargon = "valid,look-ahead,hold ,distance,margin,mirrored,not known,softmax";
    for jargon in jargon.split(',') {
        assert!(!seen.contains(jargon), "{jargon}: {seen}");
    }

    // Each "?" has a name, and explains.
    let helps = browser.value("document.querySelectorAll('main details.what').length");
    assert!(helps.as_u64().unwrap() >= 4, "{helps}");
    let named = "[...document.querySelectorAll('details.what summary')].every((one) => one.ariaLabel?.length > 10)";
    assert!(browser.is(named));
    let open = "document.querySelector('.placement details.what p').checkVisibility()";
    assert!(!browser.is(open));
    browser.value("document.querySelector('.placement details.what summary').click()");
    assert!(browser.is(open));
    browser.screenshot(&pictures().join("words.png"));
    let inside = "(() => { const { left, right, top, bottom } = document.querySelector('.placement details.what p').getBoundingClientRect(); \
        return left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight; })()";
    assert!(browser.is(inside), "an explanation outside the window");
    browser.press("Escape");
    assert!(!browser.is(open));

    // Numbers are there for those who open them.
    let number = "$distance.checkVisibility()";
    assert!(!browser.is(number));
    browser.value("document.querySelector('#fit summary').click()");
    assert!(browser.is(number));
    assert!(browser.text("distance").parse::<f64>().is_ok());
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
