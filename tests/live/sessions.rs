//! Record of a person's sessions: what was recorded is listed with numbers, on the screen and on paper.

use myointent::live::{Live, Source};
use serde_json::{Value, json};
use shared::model::file::Model;

use super::browser::{self, Browser, BrowserKind, FITS};
use super::record::{SHORT, pictures, reach, record, wish};
use super::shipped;
use super::viewer::{Viewer, get};

/// Sessions of the person, as the program sends them.
fn sessions(live: &Live) -> Value {
    let (status, answer) = get(live.url(), "sessions.json");
    let (_, json) = answer.split_once("\r\n\r\n").unwrap();
    assert_eq!(status, 200, "{answer}");
    serde_json::from_str(json).unwrap()
}

#[test]
fn the_sessions_of_a_person_are_listed_with_their_numbers_and_print_on_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let live = record(folder.path(), Source::Demo, SHORT, 16);
    assert_eq!(sessions(&live)["sessions"], json!([]));
    let mut leader = Viewer::connect(live.url());
    leader.find("report", |report| report["valid"] == true);
    wish(&mut leader, "begin");
    reach(&mut leader, |message| message["phase"] == "over");
    leader.find("kept", |_| true);
    // A note, and a task that measures.
    leader.say(r#"{"do":"note","text":"a loose band"}"#);
    leader.say(r#"{"do":"blocks","begin":true}"#);
    let ended = leader.find("blocks", |message| message["state"] == "done");
    leader.find("remarks", |message| message["remarks"][1].is_object());
    let found = sessions(&live);
    let [session] = &found["sessions"].as_array().unwrap()[..] else {
        panic!("{found}");
    };
    assert_eq!(session["protocol"], "short");
    assert_eq!(session["is_synthetic"], true);
    assert!(session["seconds"].as_f64().unwrap() > 30.0, "{session}");
    // Two rounds of six gestures, made for the model.
    assert!(session["gestures"].as_u64().unwrap() >= 10, "{session}");
    assert!(session["recognised"].as_f64().unwrap() > 0.7, "{session}");
    let reaction = session["reaction"].as_f64().unwrap();
    assert!((50.0..1000.0).contains(&reaction), "{session}");
    assert!(session["flicker"].is_f64() && session["false_activations"].is_f64());
    let remarks = &session["remarks"];
    assert_eq!(remarks[0]["text"], "a loose band");
    assert_eq!(remarks[1]["score"], ended["moved"]);
    assert!(ended["moved"].as_u64().unwrap() > 7, "{ended}");
    // Nothing but gestures was asked for.
    assert_eq!(session["raised"], Value::Null);

    if let Some(mut browser) = Browser::start(BrowserKind::Chromium) {
        browser.look(1366, 768, "dark", "no-preference");
        browser.open(live.url());
        browser.wait_for("$history?.checkVisibility()");
        let record = browser.value("$history.href");
        browser.open(record.as_str().unwrap());
        browser.wait_for("document.querySelectorAll('#sessions tbody tr').length === 3");
        let said = browser.value("document.querySelector('#sessions tbody').innerText");
        let said = said.as_str().unwrap();
        assert!(
            said.contains("a loose band") && said.contains(" blocks in 60 s"),
            "{said}"
        );
        let row = "[...document.querySelectorAll('#sessions tbody tr:first-child td')].map((cell) => cell.textContent).join('|')";
        let row = browser.value(row);
        let row = row.as_str().unwrap();
        assert!(
            row.contains("short, simulated|") && row.contains(" %|"),
            "{row}"
        );
        let model = Model::parse(&shipped()).unwrap().checksum;
        let model = format!("{model:08x}, myointent {}.", env!("CARGO_PKG_VERSION"));
        assert!(browser.text("model").ends_with(&model));
        for (name, width, height) in [("wide", 1366, 768), ("phone", 390, 844)] {
            browser.look(width, height, "light", "no-preference");
            assert!(browser.is(FITS), "{name}");
            browser.screenshot(&pictures().join(format!("sessions-{name}.png")));
        }
        // Printed, it is one page without buttons, dark on white.
        browser.look(1366, 768, "dark", "no-preference");
        let paper = browser.command("Page.printToPDF", json!({ "preferCSSPageSize": true }));
        let pages = browser::base64(paper["data"].as_str().unwrap());
        let pages = String::from_utf8_lossy(&pages)
            .matches("/Type /Page\n")
            .count();
        assert_eq!(pages, 1);
        // Nothing is wider than A4 within its margins: 178 mm.
        browser.look(673, 900, "dark", "no-preference");
        browser.command("Emulation.setEmulatedMedia", json!({ "media": "print" }));
        assert!(browser.is(FITS), "paper");
        let buttons = "[...document.querySelectorAll('button, a')].filter((one) => one.checkVisibility()).length";
        assert_eq!(browser.value(buttons), 0);
        assert_eq!(
            browser.value("getComputedStyle(document.querySelector('td')).color"),
            "rgb(0, 0, 0)"
        );
        assert_eq!(browser.complaints, [""; 0]);
    }
    live.stop().unwrap();
}
