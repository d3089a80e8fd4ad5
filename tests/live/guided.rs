//! Guided session in a browser: led by keys, judged, and ended with a tuned model.

use std::time::{Duration, Instant};

use myointent::live::Source;
use recordings::{LoadOptions, load};
use serde_json::Value;

use super::browser::Browser;
use super::record::{pictures, record, short_with_point, step};
use super::viewer::Viewer;

#[test]
fn a_guided_session_in_a_browser_ends_with_a_tuned_model() {
    let name = "a_guided_session_in_a_browser_ends_with_a_tuned_model";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, &short_with_point(), 8);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for("document.getElementById('source')?.dataset.state === 'connected'");
    let phase =
        |phase: &str| format!("document.getElementById('session')?.dataset.phase === '{phase}'");
    browser.wait_for(&phase("waiting"));
    let shown =
        "!document.getElementById('session').hidden && document.title === 'myointent record'";
    assert_eq!(browser.value(shown), true);
    let steps = "[...document.querySelectorAll('#steps li')].map((step) => `${step.id} ${step.dataset.state}`).join()";
    assert_eq!(
        browser.value(steps),
        "step-connect done,step-record now,step-tune next,step-compare next"
    );
    assert_eq!(
        browser.value("document.getElementById('legend').offsetParent"),
        Value::Null,
        "a legend of scores that are not drawn"
    );
    browser.press("Enter");
    let task = |text: &str| format!("document.getElementById('task').textContent === '{text}'");
    browser.wait_for(&task("Open the hand wide"));
    assert_eq!(
        browser.value("document.getElementById('hand').childElementCount > 10"),
        true
    );
    assert_eq!(
        browser.value("Number(document.getElementById('count').textContent) > 0"),
        true
    );
    browser.press("r");
    browser.wait_for("document.getElementById('progress').textContent.includes('1 not used')");
    browser.wait_for(&task("Make a fist"));
    browser.press("h");
    browser.wait_for(&phase("held"));
    assert_eq!(browser.text("task"), "Waiting for you");
    let end = Instant::now() + Duration::from_secs(200);
    while browser.value(&phase("over")) != true {
        assert!(Instant::now() < end, "{}", browser.text("session"));
        if browser.value(&phase("held")) == true {
            browser.press("Enter");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    browser.wait_for("!document.getElementById('result').hidden");
    assert!(
        browser.text("verdict").starts_with("Good enough"),
        "{}",
        browser.text("result")
    );
    assert!(
        browser
            .text("commands")
            .contains("myointent personalize --model")
    );
    let main =
        "[...document.querySelectorAll('#result button.main')].map((button) => button.id).join()";
    assert_eq!(browser.value(main), "tune");
    let mut beside = Viewer::connect(live.url());
    beside.find("samples", |_| true);
    browser.press("t");
    // Tuning takes some seconds of both cores, which may be busy.
    let tuning = "document.getElementById('tuned').dataset.state === 'running'";
    browser.wait_for("Boolean(document.getElementById('tuned').dataset.state)");
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
    // Progress comes before the first step and after each; then it is over.
    // Of how many, is known with the first step.
    let of = shares[1].1;
    let expected = (1..=of).map(|steps| (steps, of)).chain([(0, 0)]);
    assert!(of >= 40 && shares[0].0 == 0, "{shares:?}");
    assert!(shares[1..].iter().copied().eq(expected), "{shares:?}");
    browser.wait_for(&format!("!({tuning})"));
    let state = browser.value("document.getElementById('tuned').dataset.state");
    let written = folder.path().join("anna/anna.intent").exists();
    assert_ne!(state, "failed", "{}", browser.text("tuned"));
    assert_eq!(written, state == "better", "{}", browser.text("tuned"));
    assert_eq!(browser.text("commands").contains("install"), written);
    // There is no board.
    assert_eq!(
        browser.value("document.getElementById('install').hidden"),
        true
    );
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
    assert_eq!(browser.value(drawn), true);
    let copy = "document.querySelector('.command button')";
    browser.value(&format!("{copy}.click()"));
    browser.wait_for(&format!(
        "['Copied', 'Selected'].includes({copy}.textContent)"
    ));
    for done in ["record", "tune", "compare"] {
        assert_eq!(browser.value(&step(done, "done")), true, "{done}");
    }
    assert!(browser.text("step-compare").contains("tuned"));
    let next = if written { "" } else { "again" };
    assert_eq!(browser.value(main), next);
    browser.screenshot(&pictures().join("record-result.png"));
    browser.press("n");
    browser.wait_for(&phase("waiting"));
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    let library = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["synthetic/anna"]);
}

#[test]
#[ignore = "pictures of a session in real time, for docs/record.md"]
fn pictures_of_a_session() {
    let Some(mut browser) = Browser::start("pictures_of_a_session") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let text = web::record::protocol::text("quick-six").unwrap();
    let live = record(folder.path(), Source::Demo, &text, 1);
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for("document.getElementById('session')?.dataset.phase === 'waiting'");
    std::thread::sleep(Duration::from_millis(4500));
    browser.screenshot(&pictures().join("record-waiting.png"));
    browser.press("Enter");
    for (text, name, width, height, scheme) in [
        ("Open the hand wide", "open", 1440, 900, "light"),
        ("Make a fist", "close", 1440, 900, "dark"),
        (
            "Bend the wrist towards the palm",
            "wave-in",
            390,
            844,
            "light",
        ),
        (
            "Bend the wrist away from the palm",
            "wave-out",
            1440,
            900,
            "light",
        ),
        (
            "Touch the thumb with the index finger",
            "pinch",
            1024,
            700,
            "light",
        ),
    ] {
        browser.wait_for(&format!(
            "document.getElementById('task').textContent === '{text}'"
        ));
        browser.look(width, height, scheme, "no-preference");
        std::thread::sleep(Duration::from_millis(1600));
        browser.screenshot(&pictures().join(format!("record-{name}.png")));
        let fits = "document.documentElement.scrollWidth <= innerWidth";
        assert_eq!(browser.value(fits), true, "{name} is wider than the window");
    }
    browser.look(1440, 900, "light", "no-preference");
    browser.press("e");
    browser.press("e");
    browser.wait_for("!document.getElementById('result').hidden");
    browser.screenshot(&pictures().join("record-early.png"));
    live.stop().unwrap();
}
