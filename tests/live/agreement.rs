//! Label beside cue: whether they agree, in words and shape, and how often they did.

use myointent::live::Source;
use recordings::Recording;
use shared::intent::Intent;

use super::browser::Browser;
use super::record::pictures;
use super::{demo_page, serve, synthetic};

/// Widths and colours of the lines that the page draws from now on.
const WATCH_LINES: &str = "(() => { window.drawn = {}; \
    const stroke = CanvasRenderingContext2D.prototype.stroke; \
    CanvasRenderingContext2D.prototype.stroke = function (...all) { \
        (window.drawn[this.strokeStyle] ??= new Set()).add(this.lineWidth); return stroke.apply(this, all); }; \
    return true; })()";

/// A recording whose open and closed hands are named the other way round.
fn swapped() -> Recording {
    let mut recording = synthetic(60);
    for label in recording.labels.iter_mut().flatten() {
        *label = match *label {
            Intent::Open => Intent::Close,
            Intent::Close => Intent::Open,
            other => other,
        };
    }
    recording
}

/// Share of the labels in gestures that are as asked, in per cent.
fn share(browser: &mut Browser) -> u32 {
    let text = browser.text("share");
    let number = text.split(" % in gestures").next().unwrap();
    let number = number.rsplit(' ').next().unwrap();
    number.parse().unwrap_or_else(|_| panic!("{text}"))
}

#[test]
fn a_label_that_is_not_as_asked_is_marked_in_words_and_counted() {
    let name = "a_label_that_is_not_as_asked_is_marked_in_words_and_counted";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let right = "document.getElementById('agrees')?.dataset.state === 'right'";
    let wrong = "document.getElementById('agrees')?.dataset.state === 'wrong'";
    let counted = "Number(document.getElementById('share')?.dataset.gestures) > 40";
    browser.look(1440, 900, "light", "no-preference");
    for (what, recording) in [("right", synthetic(60)), ("wrong", swapped())] {
        let live = serve(Source::Replay(Box::new(recording)));
        browser.open(live.url());
        let (state, text) = match what {
            "right" => (right, "✓as asked"),
            _ => (wrong, "✗not as asked"),
        };
        browser.wait_for(&format!(
            "{state} && document.getElementById('label').textContent !== 'relax'"
        ));
        // One frame, or it could be another state's.
        let shown = browser.value(&format!(
            "{state} ? document.getElementById('agrees').textContent : '{text}'"
        ));
        assert_eq!(shown, text);
        browser.screenshot(&pictures().join(format!("agrees-{what}.png")));
        browser.wait_for(counted);
        let share = share(&mut browser);
        let expected = if what == "right" { 60..=100 } else { 0..=40 };
        assert!(expected.contains(&share), "{what}: {share} %");
        live.stop().unwrap();
    }
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn rest_is_right_where_a_gesture_is_asked_for_that_the_model_lacks() {
    let name = "rest_is_right_where_a_gesture_is_asked_for_that_the_model_lacks";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let mut recording = synthetic(60);
    for label in recording.labels.iter_mut().flatten() {
        if *label == Intent::Relax {
            *label = Intent::Pinch;
        }
    }
    let live = serve(Source::Replay(Box::new(recording)));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(
        "document.querySelector('#truth b')?.textContent === 'pinch' && \
         document.getElementById('label').textContent === 'relax' && \
         document.getElementById('agrees').dataset.state === 'right'",
    );
    // Such a gesture means nothing, as other movement does.
    browser.wait_for("document.getElementById('share').textContent.includes('in other movement')");
    // Nothing is asked for by a stream that is lost.
    live.stop().unwrap();
    browser.wait_for("document.getElementById('truth').hidden");
    assert_eq!(browser.complaints, [""; 0]);
}

/// Expression of the states of the mark that the page shows while label and cue are equal, over some seconds.
const WHILE_EQUAL: &str = "new Promise((done) => { const states = new Set(); const end = performance.now() + 6000; \
    const look = () => { const [label, asked] = ['#label', '#truth b'].map((name) => document.querySelector(name).textContent); \
        if (label === asked) states.add(document.getElementById('agrees').dataset.state); \
        if (performance.now() < end) requestAnimationFrame(look); else done([...states].join()); }; look(); })";

#[test]
fn a_label_that_equals_what_is_asked_is_never_called_changing() {
    let name = "a_label_that_equals_what_is_asked_is_never_called_changing";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes'");
    assert_eq!(browser.value(WHILE_EQUAL), "right");
    live.stop().unwrap();
}

#[test]
fn the_score_of_other_movement_is_drawn_as_strong_as_the_others() {
    let name = "the_score_of_other_movement_is_drawn_as_strong_as_the_others";
    let Some((mut browser, live)) = demo_page(name) else {
        return;
    };
    browser.wait_for("document.getElementById('valid')?.dataset.valid === 'yes'");
    browser.value(WATCH_LINES);
    browser.frames(5);
    let colour = |name: &str| {
        format!(
            "Math.max(0, ...(window.drawn[getComputedStyle(document.documentElement).getPropertyValue('--{name}').trim()] ?? []))"
        )
    };
    let open = browser.value(&colour("open"));
    assert_eq!(open, 2);
    assert_eq!(browser.value(&colour("other")), open);
    live.stop().unwrap();
}
