//! An alignment: that of the demo is right, every one can be taken back, and one that makes labels worse is offered back.

use myointent::live::Source;
use serde_json::{Value, json};

use super::browser::Browser;
use super::record::pictures;
use super::viewer::Viewer;
use super::{serve, synthetic};

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
fn an_alignment_of_the_demo_finds_the_armband_as_it_sits() {
    let live = serve(Source::Demo);
    let mut viewer = Viewer::connect(live.url());
    viewer.find("report", |report| report["valid"] == true);
    for _ in 0..2 {
        viewer.say(r#"{"do":"align"}"#);
        let ended = viewer.find("alignment", |message| message["state"] != "waiting");
        assert_eq!(ended["state"], "aligned", "{ended}");
        assert_eq!(placed(&ended), (0, false), "{ended}");
    }
    live.stop().unwrap();
}

#[test]
fn a_viewer_puts_a_known_placement_in_force_and_takes_it_back() {
    let live = serve(Source::Replay(Box::new(synthetic(20))));
    let mut viewer = Viewer::connect(live.url());
    viewer.find("samples", |_| true);
    for (turn, mirrored) in [(3, true), (0, false)] {
        viewer.say(&format!(
            r#"{{"do":"place","turn":{turn},"mirrored":{mirrored}}}"#
        ));
        let set = viewer.find("alignment", |message| message["state"] == "set");
        assert_eq!(placed(&set), (turn, mirrored), "{set}");
    }
    // There are eight places.
    viewer.say(r#"{"do":"place","turn":8,"mirrored":false}"#);
    viewer.find("refused", |message| message["do"] == "place");
    live.stop().unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_board_is_told_the_placement_that_a_viewer_takes_back() {
    use super::board::{Board, Damage};

    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(&link, Damage::None);
    let live = serve(Source::Port(link));
    let mut viewer = Viewer::connect(live.url());
    viewer.find("samples", |_| true);
    for (turn, mirrored) in [(2, true), (0, false)] {
        viewer.say(&format!(
            r#"{{"do":"place","turn":{turn},"mirrored":{mirrored}}}"#
        ));
        let set = viewer.find("alignment", |message| message["state"] == "set");
        assert_eq!(placed(&set), (turn, mirrored), "{set}");
    }
    live.stop().unwrap();
    drop(board);
}

#[test]
fn the_page_says_what_an_alignment_changed_and_offers_a_worse_one_back() {
    let name = "the_page_says_what_an_alignment_changed_and_offers_a_worse_one_back";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let live = serve(Source::Demo);
    let method = "Page.addScriptToEvaluateOnNewDocument";
    browser.command(method, json!({ "source": WATCH_SOCKET }));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    // Gestures are labelled as asked so far.
    browser.wait_for("Number(document.getElementById('share')?.dataset.gestures) > 40");
    let mut other = Viewer::connect(live.url());
    browser.value(PLACE);
    browser.wait_for("document.getElementById('placement').textContent.includes('turned by 2 places, on the other arm')");
    assert_eq!(
        browser.value(
            "document.getElementById('undo').disabled || document.getElementById('undo').hidden"
        ),
        false
    );
    // It labels gestures wrong: nobody has to notice that by himself.
    browser.wait_for("document.getElementById('undo').classList.contains('main')");
    let text = browser.text("worse");
    assert!(text.contains("as asked"), "{text}");
    browser.screenshot(&pictures().join("align-worse.png"));
    browser.press("u");
    let back = other.find("alignment", |message| placed(message) == (0, false));
    assert_eq!(back["state"], "set");
    browser.wait_for("document.getElementById('undo').hidden");
    browser.wait_for("!document.getElementById('placement').textContent.includes('turned')");
    assert_eq!(browser.text("worse"), "");
    browser.screenshot(&pictures().join("align-back.png"));

    // A page that is loaded again can still take it back.
    browser.value(PLACE);
    browser.wait_for("!document.getElementById('undo').hidden");
    browser.open(live.url());
    browser.wait_for("document.getElementById('undo')?.hidden === false");
    assert_eq!(browser.text("undo").trim(), "Undo: in its usual place U");
    browser.press("u");
    other.find("alignment", |message| placed(message) == (0, false));
    browser.wait_for("document.getElementById('undo').hidden");

    // A page that is opened later does not know what was before, and can still reset it.
    browser.value(PLACE);
    browser.wait_for("!document.getElementById('undo').hidden");
    browser.value("sessionStorage.clear()");
    browser.open(live.url());
    browser.wait_for("document.getElementById('reset')?.hidden === false");
    browser.value("document.getElementById('reset').click()");
    other.find("alignment", |message| placed(message) == (0, false));
    browser.wait_for("document.getElementById('reset').hidden");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
