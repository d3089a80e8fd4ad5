//! The page of a recording: it moves, says whether labels are as asked, pauses, saves, and says when the stream is gone.

use std::path::Path;

use myointent::live::Source;
use recordings::{LoadOptions, Recording, load_bytes};
use shared::intent::Intent;

use super::browser::{Browser, CATCH, LOST, VALID};
use super::record::pictures;
use super::{serve, synthetic};

/// Script whose value changes with every change of the picture.
pub const PICTURE: &str = "$traces.toDataURL().split('').reduce((sum, letter) => (sum * 31 + letter.charCodeAt(0)) | 0, 7)";

/// Waits until a label of a gesture is marked, and then until the share of right ones is known. Returns it in percent.
fn share(browser: &mut Browser, state: &str, text: &str) -> u64 {
    let state = format!("$agrees?.dataset.state === '{state}'");
    browser.wait_for(&format!("{state} && $label.textContent !== 'relax'"));
    // One frame, or it could be another state's.
    let shown = format!("!({state}) || $agrees.textContent === '{text}'");
    assert!(browser.is(&shown), "{text}");
    browser.wait_for("Number($share?.dataset.gestures) > 40");
    let share = browser.value("Number(/(\\d+) % in gestures/.exec($share.textContent)[1])");
    share.as_u64().unwrap()
}

/// The recording with other labels.
fn relabelled(mut recording: Recording, other: impl Fn(Intent) -> Intent) -> Recording {
    for label in recording.labels.iter_mut().flatten() {
        *label = other(*label);
    }
    recording
}

#[test]
fn the_page_follows_a_recording_pauses_and_saves_what_it_saw() {
    let recording = synthetic(60);
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(recording.clone()))));
    browser.wait_for(VALID);
    browser.value(CATCH);

    // Traces move, and the label becomes what the recording says it is, and something else again.
    let before = browser.value(PICTURE);
    browser.wait_for(&format!("{PICTURE} !== {before}"));
    for class in ["open", "close", "relax"] {
        browser.wait_for(&format!("$label.textContent === '{class}'"));
    }
    let share = share(&mut browser, "right", "✓as asked");
    assert!(share >= 60, "{share} %");
    browser.wait_for("Number($rate.textContent) > 190");
    let delay = browser.text("delay");
    let delay: u32 = delay.strip_suffix(" ms").unwrap().parse().unwrap();
    assert!((5..=255).contains(&delay), "{delay} ms");
    assert_eq!(browser.text("lost"), "0");

    // Paused in a gesture, the picture stands, and keys show the label and the cue of where it is.
    browser.wait_for("$label.textContent === 'relax'");
    browser.wait_for("$label.textContent !== 'relax'");
    browser.press(" ");
    assert_eq!(browser.value("$pause.ariaPressed"), "true");
    // The picture stops once the labels have come that are later by their look-ahead.
    browser.wait_for(&format!(
        "(async () => {{ const before = {PICTURE}; \
         for (let frame = 0; frame < 20; frame++) await new Promise(requestAnimationFrame); \
         return {PICTURE} === before; }})()"
    ));
    let mut shown = |key: &str| {
        browser.press(key);
        browser.frames(2);
        [browser.text("label"), browser.text("truth")]
    };
    let mut labels = vec![shown("Shift")];
    labels.extend((0..5).map(|_| shown("ArrowLeft")));
    let is_rest = |[label, _]: &[String; 2]| label == "relax";
    let is_other = |[_, cue]: &[String; 2]| *cue != labels[0][1];
    assert!(labels.iter().any(is_rest), "{labels:?}");
    assert!(labels.iter().any(is_other), "{labels:?}");
    let back: Vec<_> = (0..5).map(|_| shown("ArrowRight")).collect();
    assert!(labels.iter().rev().skip(1).eq(&back), "{labels:?} {back:?}");
    browser.press(" ");
    assert_eq!(browser.value("$pause.ariaPressed"), "false");

    browser.press("m");
    browser.frames(20);
    browser.press("s");
    browser.wait_for("Boolean(window.saved)");
    let text = browser.value("window.saved.text()");
    let text = text.as_str().unwrap();
    assert!(text.contains(",mark 1\n"), "no mark in the csv");
    let library = load_bytes(Path::new("a.csv"), text.as_bytes(), &LoadOptions::default());
    let found = &library.unwrap().recordings[0];
    let first = text.lines().nth(1).unwrap().split(',').nth(9).unwrap();
    let first: usize = first.parse().unwrap();
    let expected = first..(first + found.samples.len()).min(recording.samples.len());
    assert!(expected.len() > 1000, "{expected:?}");
    assert_eq!(
        found.samples[..expected.len()],
        recording.samples[expected.clone()]
    );
    assert_eq!(found.labels[..expected.len()], recording.labels[expected]);

    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    browser.wait_for(LOST);
    assert!(browser.text("source").contains("has ended"));
}

#[test]
fn labels_not_as_asked_a_gesture_that_the_model_lacks_and_a_loose_electrode_are_named() {
    let swapped = relabelled(synthetic(60), |label| match label {
        Intent::Open => Intent::Close,
        Intent::Close => Intent::Open,
        other => other,
    });
    let (mut browser, live) = open!(serve(Source::Replay(Box::new(swapped))));
    let share = share(&mut browser, "wrong", "✗not as asked");
    assert!(share <= 40, "{share} %");
    browser.screenshot(&pictures().join("agrees-wrong.png"));
    live.stop().unwrap();

    let mut lacking = relabelled(synthetic(60), |label| match label {
        Intent::Relax => Intent::Pinch,
        other => other,
    });
    for sample in &mut lacking.samples {
        sample[2] = 0;
    }
    let live = serve(Source::Replay(Box::new(lacking)));
    browser.open(live.url());
    // Rest is right: such a gesture is none of the model's.
    browser.wait_for(
        "document.querySelector('#truth b')?.textContent === 'pinch' && \
         $label.textContent === 'relax' && \
         $agrees.dataset.state === 'right' && $agrees.textContent.endsWith('correctly ignored')",
    );
    // Nobody is there who could be advised.
    let low = "import('./now.js').then(({ Now }) => { new Now().share({ gestures: [0, 30], rest: [0, 0], other: [0, 0] }); return $low.checkVisibility(); })";
    assert_eq!(browser.value(low), false);
    browser.wait_for("$share.textContent.includes('of other movement ignored')");
    browser.wait_for("$electrodes?.textContent.startsWith('Electrode 3 has no contact:')");
    let faults = "document.querySelectorAll('#armband .pod.fault').length";
    assert_eq!(browser.value(faults), 1);
    browser.screenshot(&pictures().join("electrode.png"));
    // Nothing is asked for by a stream that is lost.
    live.stop().unwrap();
    browser.wait_for("$truth.hidden && $electrodes.textContent === ''");
    assert_eq!(browser.complaints, [""; 0]);
}
