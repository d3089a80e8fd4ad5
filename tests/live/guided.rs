//! Guided session in a browser: led by keys, judged, and ended with a tuned model.

use std::time::{Duration, Instant};

use myointent::live::Source;
use recordings::{LoadOptions, load};

use super::browser::{CONNECTED, VALID};
use super::record::{phase, pictures, record, short_with_point, step};
use super::viewer::Viewer;

#[test]
fn a_guided_session_in_a_browser_ends_with_a_tuned_model() {
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
    browser.wait_for(&task("Make a fist"));
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
    let mut beside = Viewer::connect(live.url());
    beside.find("samples", |_| true);
    browser.press("t");
    // Tuning takes some seconds of both cores, which may be busy.
    let tuning = "$tuned.dataset.state === 'running'";
    browser.wait_for("Boolean($tuned.dataset.state)");
    let end = Instant::now() + Duration::from_secs(400);
    let mut shares = Vec::new();
    while shares.last() != Some(&(0, 0)) {
        assert!(Instant::now() < end, "{}", browser.text("tuned"));
        let message = beside.next().expect("a message, not the end");
        if message["type"] == "tuning" {
            let number = |field: &str| message[field].as_u64().unwrap();
            shares.push((number("steps"), number("of")));
        }
    }
    // Progress comes before the first step and after each, then it is over; of how many, is known with the first step.
    let of = shares[1].1;
    let expected = (1..=of).map(|steps| (steps, of)).chain([(0, 0)]);
    assert!(of >= 40 && shares[0].0 == 0, "{shares:?}");
    assert!(shares[1..].iter().copied().eq(expected), "{shares:?}");
    browser.wait_for(&format!("!({tuning})"));
    let state = browser.value("$tuned.dataset.state");
    let written = folder.path().join("anna/anna.intent").exists();
    assert_ne!(state, "failed", "{}", browser.text("tuned"));
    assert_eq!(written, state == "better", "{}", browser.text("tuned"));
    assert_eq!(browser.text("commands").contains("install"), written);
    // There is no board: it can be used here.
    assert_eq!(browser.is("!$install.hidden"), written);
    let scores = browser.text("scores");
    for row in ["balanced accuracy", "other movements that raise a label"] {
        assert!(scores.contains(row), "{scores}");
    }
    browser.value("document.querySelector('#scores details.what summary').click()");
    assert!(browser.text("scores").contains("each gesture counts alike"));
    browser.press("Escape");
    let told = browser.text("tuned");
    for half in [
        "Of the gestures ",
        "A minute of movement that means nothing raises ",
    ] {
        assert!(told.contains(half), "{told}");
    }
    let headline = if written {
        "A model of your own is ready"
    } else {
        "The old model stays"
    };
    assert!(
        browser.text("verdict").starts_with(headline),
        "{}",
        browser.text("verdict")
    );
    let drawn = "[...document.querySelectorAll('#scores tbody tr')].every((row) => row.querySelectorAll('.bars i').length === 2)";
    assert!(browser.is(drawn));
    let copy = "document.querySelector('.command button')";
    browser.value(&format!("{copy}.click()"));
    browser.wait_for(&format!(
        "['Copied', 'Selected'].includes({copy}.textContent)"
    ));
    for done in ["record", "tune", "compare"] {
        assert!(browser.is(&step(done, "done")), "{done}");
    }
    assert!(browser.text("step-compare").contains("tuned"));
    let next = if written { "install" } else { "again" };
    assert_eq!(browser.value(main), next);
    browser.screenshot(&pictures().join("record-result.png"));
    if written {
        browser.press("i");
        browser.wait_for(&format!("$installed.dataset.state === 'done' && {VALID}"));
        assert!(browser.text("installed").contains("in use here"));
    }
    browser.press("n");
    browser.wait_for(&phase("waiting"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["synthetic/anna"]);
}
