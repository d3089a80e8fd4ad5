//! Server of the page: requests that it answers, and messages to its viewers.

use std::time::Duration;

use myointent::live::{self, Source};
use serde_json::json;

use super::viewer::{Viewer, get, request};
use super::{options, serve};

#[test]
fn the_page_is_served_to_this_machine_and_to_no_other_name_or_origin() {
    let live = serve(Source::Demo);
    let url = live.url();
    let (status, page) = get(url, "");
    assert_eq!(status, 200);
    assert!(page.contains("content-security-policy: default-src 'none'"));
    assert!(page.contains("<title>myointent live</title>"));
    // A websocket needs an upgrade.
    for (file, expected) in [
        ("live.js", 200),
        ("x", 404),
        ("sessions.json", 404),
        ("socket", 400),
    ] {
        assert_eq!(get(url, file).0, expected, "{file}");
    }
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    let rebound = "Host: evil.example\r\n";
    assert_eq!(request(url, "GET", "/socket", rebound).0, 421);
    let own = format!("Host: {host}\r\n");
    assert_eq!(request(url, "POST", "/", &own).0, 405);
    assert!(Viewer::connect_from(url, Some(&format!("http://{host}"))).is_ok());
    let foreign = Viewer::connect_from(url, Some("http://evil.example"));
    assert_eq!(foreign.err(), Some(403));
    live.stop().unwrap();
}

#[test]
fn for_other_machines_the_address_has_a_token() {
    let mut options = options(Source::Demo);
    options.listen = Some("0.0.0.0:0".parse().unwrap());
    let live = live::start(options).unwrap();
    let url = live.url();
    assert_eq!(get(url, "live.js").0, 200);
    let (root, _) = url.trim_end_matches('/').rsplit_once('/').unwrap();
    for wrong in [format!("{root}/"), format!("{root}/{}/", "0".repeat(32))] {
        assert_eq!(get(&wrong, "live.js").0, 403, "{wrong}");
        assert_eq!(Viewer::connect_from(&wrong, None).err(), Some(403));
    }
    Viewer::connect(url).find("samples", |_| true);
    live.stop().unwrap();
}

#[test]
fn viewers_are_told_alike_sixteen_at_most_until_the_end_and_who_talks_nonsense_is_put_out() {
    let live = serve(Source::Demo);
    let url = live.url().to_owned();
    let mut one = Viewer::connect(&url);
    let mut other = Viewer::connect(&url);
    one.say(&json!({ "do": "mark", "sample": 7, "text": "first grip" }).to_string());
    for viewer in [&mut one, &mut other] {
        assert_eq!(viewer.find("mark", |_| true)["sample"], 7);
    }
    one.say(r#"{"do":"ping","sent":12.5}"#);
    assert_eq!(one.find("pong", |_| true)["sent"], 12.5);
    let long = json!({ "do": "mark", "sample": 1, "text": "x".repeat(5000) }).to_string();
    for said in ["", "[]", r#"{"do":"reboot"}"#, r#"{"do":"mark"}"#, &long] {
        let mut bad = Viewer::connect(&url);
        bad.say(said);
        while bad.next().is_some() {}
    }
    // The place of one who has left becomes free in a moment.
    let wait = |_| std::thread::sleep(Duration::from_millis(10));
    let join = || (0..1000).find_map(|_| Viewer::connect_from(&url, None).map_err(wait).ok());
    let mut more: Vec<_> = (0..14).map(|_| join().unwrap()).collect();
    assert_eq!(Viewer::connect_from(&url, None).err(), Some(503));
    more.pop();
    assert!(join().is_some());
    other.find("samples", |_| true);
    live.stop().unwrap();
    other.find("end", |_| true);
    while other.next().is_some() {}
    let address = url.trim_start_matches("http://").trim_end_matches('/');
    assert!(std::net::TcpStream::connect(address).is_err());
}
