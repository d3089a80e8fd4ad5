//! Page without a stream: what is missing, and what to do about it, step by step.

use myointent::live::Source;
use shared::myo::{Address, Following};

use super::board::Board;
use super::browser::{Browser, LOST, VALID};
use super::record::pictures;
use super::scripted::{Scripted, binding, identity};
use super::serve;

/// Waits until what is missing is named, and returns it with its steps.
fn missing(browser: &mut Browser, title: &str) -> String {
    let is_named = format!("$empty-title.textContent.includes('{title}')");
    browser.wait_for(&format!("$empty?.hidden === false && {is_named}"));
    browser.text("empty")
}

#[test]
fn a_port_that_is_not_there_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let (mut browser, live) = open!(serve(Source::Port(link.clone())));
    let text = missing(&mut browser, "there is no port");
    for part in ["USB cable", "port", "myointent live --demo"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("os error"), "{text}");
    assert!(!browser.text("source").contains("os error"));
    browser.screenshot(&pictures().join("empty-port.png"));

    // It is gone as soon as there is something to see, and back when that is gone.
    let board = Board::start(&link);
    browser.wait_for(&format!("$empty.hidden && {VALID}"));
    browser.wait_for("$battery.textContent === '80 %'");
    assert!(browser.text("legend").contains("--model FILE"));
    drop(board);
    // The words come with the message, and the label goes with the next frame.
    browser.wait_for(&format!("{LOST} && $label.textContent === '–'"));
    missing(&mut browser, "looking for it again");

    // A file is no port.
    std::fs::remove_file(&link).unwrap();
    std::fs::write(&link, "").unwrap();
    missing(&mut browser, "is no serial port");
    live.stop().unwrap();
    let text = missing(&mut browser, "has ended");
    assert!(text.contains("Start it again"), "{text}");
}

/// Plays a board without samples that follows an armband, or none.
fn quiet(browser: &mut Browser, following: Following, title: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Scripted::start(&link, move |_| {
        identity(7).to_string() + &binding(following).to_string()
    });
    let live = serve(Source::Port(link));
    browser.open(live.url());
    let text = missing(browser, title);
    live.stop().unwrap();
    drop(board);
    text
}

#[test]
fn a_board_whose_armband_sleeps_or_is_not_bound_yet_says_what_to_do() {
    let mut browser = start!();
    browser.look(1440, 900, "light", "no-preference");
    let armband = Address::parse("FA:12:34:56:78:9A").unwrap();
    let asleep = quiet(&mut browser, Following::Bound(armband), "FA:12:34:56:78:9A");
    assert!(asleep.contains("move the hand"), "{asleep}");
    let unbound = quiet(&mut browser, Following::Nobody, "follows no armband");
    assert!(unbound.contains("bind begin"), "{unbound}");
}
