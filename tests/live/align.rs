//! An alignment can be taken back on the page, and one that makes labels worse is offered back.

use myointent::live::Source;
use serde_json::{Value, json};

use super::record::pictures;
use super::serve;
use super::viewer::Viewer;

/// Script that keeps the page's websocket, to speak for the page.
const WATCH_SOCKET: &str = "window.WebSocket = class extends WebSocket { constructor(...all) { super(...all); window.socket = this; } };";
/// Script that has the page put a wrong placement in force.
const PLACE: &str = "socket.send(JSON.stringify({ do: 'place', turn: 2, mirrored: true })) ?? true";

/// Turn of a placement, and whether it is mirrored.
fn placed(message: &Value) -> (u64, bool) {
    let turn = message["turn"].as_u64().unwrap();
    (turn, message["mirrored"].as_bool().unwrap())
}

#[test]
fn the_page_says_what_an_alignment_changed_and_offers_a_worse_one_back() {
    let mut browser = start!();
    let live = serve(Source::Demo);
    let method = "Page.addScriptToEvaluateOnNewDocument";
    browser.command(method, json!({ "source": WATCH_SOCKET }));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    // Gestures are labelled as asked so far.
    browser.wait_for("Number($share?.dataset.gestures) > 40");
    let mut other = Viewer::connect(live.url());
    browser.value(PLACE);
    browser.wait_for("$placement.textContent.includes('Turned by 2 places, on the other arm')");
    assert!(!browser.is("$undo.disabled || $undo.hidden"));
    // It labels gestures wrong: nobody has to notice that by himself.
    browser.wait_for("$undo.classList.contains('main')");
    let text = browser.text("worse");
    assert!(text.contains("as asked"), "{text}");
    browser.screenshot(&pictures().join("align-worse.png"));
    browser.press("u");
    let back = other.find("alignment", |message| placed(message) == (0, false));
    assert_eq!(back["state"], "set");
    browser.wait_for("$undo.hidden");
    browser.wait_for("!/turned/i.test($placement.textContent)");
    assert_eq!(browser.text("worse"), "");
    browser.screenshot(&pictures().join("align-back.png"));

    // A page that is loaded again can still take it back.
    browser.value(PLACE);
    browser.wait_for("!$undo.hidden");
    browser.open(live.url());
    browser.wait_for("$undo?.hidden === false");
    assert_eq!(browser.text("undo").trim(), "Undo: in its usual place U");
    browser.press("u");
    other.find("alignment", |message| placed(message) == (0, false));
    browser.wait_for("$undo.hidden");

    // A page that is opened later does not know what was before, and can still reset it.
    browser.value(PLACE);
    browser.wait_for("!$undo.hidden");
    browser.value("sessionStorage.clear()");
    browser.open(live.url());
    browser.wait_for("$reset?.hidden === false");
    browser.value("$reset.click()");
    other.find("alignment", |message| placed(message) == (0, false));
    browser.wait_for("$reset.hidden");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
