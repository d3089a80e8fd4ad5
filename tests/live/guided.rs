//! Guided session in a browser: led by keys, and judged.

use std::time::{Duration, Instant};

use myointent::live::Source;
use recordings::{LoadOptions, load};

use super::browser::CONNECTED;
use super::record::{phase, pictures, record, short_with_point};

#[test]
fn a_guided_session_in_a_browser_ends_with_a_verdict_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let (mut browser, live) = open!(record(folder.path(), Source::Demo, &short_with_point(), 8));
    browser.wait_for(CONNECTED);
    browser.wait_for(&phase("waiting"));
    assert!(browser.is("!$session.hidden && document.title === 'myointent record'"));
    let steps = "[...document.querySelectorAll('#steps li')].map((step) => `${step.id} ${step.dataset.state}`).join()";
    assert_eq!(
        browser.value(steps),
        "step-connect done,step-record now,step-tune next,step-compare next,step-install next"
    );
    // No legend of scores that are not drawn.
    assert!(browser.is("$legend.offsetParent === null"));
    browser.press("Enter");
    let task = |text: &str| format!("$task.textContent === '{text}'");
    browser.wait_for(&task("Open the hand wide"));
    assert!(browser.is("$hand.childElementCount > 10"));
    assert!(browser.is("Number($count.textContent) > 0"));
    browser.press("r");
    browser.wait_for("$progress.textContent.includes('1 not used')");
    browser.wait_for(&task("Close the hand to a fist"));
    browser.press("h");
    browser.wait_for(&phase("held"));
    assert_eq!(browser.text("task"), "Waiting for you");
    let end = Instant::now() + Duration::from_secs(200);
    while !browser.is(&phase("over")) {
        assert!(Instant::now() < end, "{}", browser.text("session"));
        if browser.is(&phase("held")) {
            browser.press("Enter");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    browser.wait_for("!$result.hidden");
    let result = browser.text("result");
    assert!(
        browser.text("verdict").starts_with("Good enough"),
        "{result}"
    );
    assert!(result.contains("myointent personalize --model"), "{result}");
    let main =
        "[...document.querySelectorAll('#result button.main')].map((button) => button.id).join()";
    assert_eq!(browser.value(main), "tune");
    browser.screenshot(&pictures().join("record-result.png"));
    browser.press("n");
    browser.wait_for(&phase("waiting"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["synthetic/anna"]);
}
