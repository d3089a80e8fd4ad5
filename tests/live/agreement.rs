//! Label beside cue: whether they agree, in words and shape, and how often they did.

use myointent::live::Source;
use recordings::Recording;
use shared::intent::Intent;

use super::browser::VALID;
use super::record::pictures;
use super::{serve, synthetic};

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

#[test]
fn a_label_that_is_not_as_asked_is_marked_in_words_and_counted() {
    let mut browser = start!();
    browser.look(1440, 900, "light", "no-preference");
    for (what, text, recording, expected) in [
        ("right", "✓as asked", synthetic(60), 60..=100),
        ("wrong", "✗not as asked", swapped(), 0..=40),
    ] {
        let live = serve(Source::Replay(Box::new(recording)));
        browser.open(live.url());
        let state = format!("$agrees?.dataset.state === '{what}'");
        browser.wait_for(&format!("{state} && $label.textContent !== 'relax'"));
        // One frame, or it could be another state's.
        let shown = format!("!({state}) || $agrees.textContent === '{text}'");
        assert!(browser.is(&shown), "{text}");
        browser.screenshot(&pictures().join(format!("agrees-{what}.png")));
        browser.wait_for("Number($share?.dataset.gestures) > 40");
        let share = browser.value("Number(/(\\d+) % in gestures/.exec($share.textContent)[1])");
        assert!(
            expected.contains(&share.as_u64().unwrap()),
            "{what}: {share} %"
        );
        live.stop().unwrap();
    }
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn rest_is_right_where_a_gesture_is_asked_for_that_the_model_lacks() {
    let mut recording = synthetic(60);
    for label in recording.labels.iter_mut().flatten() {
        if *label == Intent::Relax {
            *label = Intent::Pinch;
        }
    }
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(recording))));
    browser.wait_for(
        "document.querySelector('#truth b')?.textContent === 'pinch' && \
         $label.textContent === 'relax' && \
         $agrees.dataset.state === 'right'",
    );
    // Such a gesture means nothing, as other movement does.
    browser.wait_for("$share.textContent.includes('in other movement')");
    // Nothing is asked for by a stream that is lost.
    live.stop().unwrap();
    browser.wait_for("$truth.hidden");
    assert_eq!(browser.complaints, [""; 0]);
}

/// Expression of the states of the mark that the page shows while label and cue are equal, over some seconds.
const WHILE_EQUAL: &str = "new Promise((done) => { const states = new Set(); const end = performance.now() + 6000; \
    const look = () => { const [label, asked] = ['#label', '#truth b'].map((name) => document.querySelector(name).textContent); \
        if (label === asked) states.add($agrees.dataset.state); \
        if (performance.now() < end) requestAnimationFrame(look); else done([...states].join()); }; look(); })";

#[test]
fn an_equal_label_is_never_called_changing_and_other_movement_is_drawn_as_strong_as_the_others() {
    let (mut browser, live) = open!(serve(Source::Demo));
    browser.wait_for(VALID);
    browser.value(WATCH_LINES);
    assert_eq!(browser.value(WHILE_EQUAL), "right");
    for name in ["open", "other"] {
        let colour = "getComputedStyle(document.documentElement).getPropertyValue";
        let width = format!("Math.max(...window.drawn[{colour}('--{name}').trim()])");
        assert_eq!(browser.value(&width), 2, "{name}");
    }
    live.stop().unwrap();
}
