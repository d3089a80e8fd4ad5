//! Server of the page: requests that it answers, and messages to viewers of a recording.

use std::time::{Duration, Instant};

use myointent::live::Source;

use super::serve;
use super::viewer::{Viewer, get, request};

#[test]
fn the_page_is_served_to_this_machine_and_to_no_other_name_or_origin() {
    let live = serve(Source::Demo);
    let url = live.url();
    let (status, page) = get(url, "");
    assert_eq!(status, 200);
    assert!(
        page.contains("content-security-policy: default-src 'none'"),
        "{page}"
    );
    assert!(page.contains("<title>myointent live</title>"));
    for (file, expected) in [
        ("live.js", 200),
        ("live.css", 200),
        ("icon.svg", 200),
        ("x", 404),
    ] {
        assert_eq!(get(url, file).0, expected, "{file}");
    }
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    let port = host.rsplit_once(':').unwrap().1;
    let rebound = format!("Host: evil.example:{port}\r\n");
    assert_eq!(request(url, "GET", "/", &rebound).0, 421);
    assert_eq!(request(url, "GET", "/socket", &rebound).0, 421);
    assert_eq!(
        request(url, "POST", "/", &format!("Host: {host}\r\n")).0,
        405
    );
    // This asks for a websocket without an upgrade.
    assert_eq!(get(url, "socket").0, 400);
    let own = format!("http://{host}");
    assert!(Viewer::connect_from(url, Some(&own)).is_ok());
    for origin in ["http://evil.example", "null", "https://localhost"] {
        let found = Viewer::connect_from(url, Some(origin)).err();
        assert_eq!(found, Some(403), "{origin}");
    }
    live.stop().unwrap();
}

#[test]
fn for_other_machines_the_address_has_a_token() {
    let live = myointent::live::start(myointent::live::Options {
        source: Source::Demo,
        model: None,
        listen: "0.0.0.0:0".parse().unwrap(),
        imu: false,
        record: None,
    })
    .unwrap();
    let url = live.url().to_owned();
    assert_eq!(get(&url, "").0, 200);
    assert_eq!(get(&url, "live.js").0, 200);
    let (root, _) = url.trim_end_matches('/').rsplit_once('/').unwrap();
    let without = format!("{root}/");
    assert_eq!(get(&without, "").0, 403);
    assert_eq!(get(&without, "live.js").0, 403);
    assert_eq!(Viewer::connect_from(&without, None).err(), Some(403));
    let other = format!("{root}/{}/", "0".repeat(32));
    assert_eq!(Viewer::connect_from(&other, None).err(), Some(403));
    Viewer::connect(&url).find("samples", |_| true);
    live.stop().unwrap();
}

#[test]
fn a_mark_is_shown_to_all_and_an_alignment_can_be_begun_and_ended() {
    let live = serve(Source::Demo);
    let mut one = Viewer::connect(live.url());
    let mut other = Viewer::connect(live.url());
    let text = "first\u{7} grip".repeat(20);
    one.say(&serde_json::json!({ "do": "mark", "sample": 7, "text": text }).to_string());
    for viewer in [&mut one, &mut other] {
        let mark = viewer.find("mark", |_| true);
        assert_eq!(mark["sample"], 7);
        let text = mark["text"].as_str().unwrap();
        assert!(text.starts_with("first grip") && text.len() == 80, "{text}");
    }
    one.say(r#"{"do":"align"}"#);
    other.find("alignment", |message| message["state"] == "waiting");
    one.say(r#"{"do":"cancel"}"#);
    other.find("alignment", |message| message["state"] == "cancelled");
    one.say(r#"{"do":"ping","sent":12.5}"#);
    let pong = one.find("pong", |_| true);
    assert_eq!(pong["sent"], 12.5);
    assert!(pong["now"].as_f64().unwrap() > 0.0);
    live.stop().unwrap();
}

#[test]
fn who_says_what_no_page_says_is_put_out_and_the_others_stay() {
    let live = serve(Source::Demo);
    let mut good = Viewer::connect(live.url());
    let long = format!(
        r#"{{"do":"mark","sample":1,"text":"{}"}}"#,
        "x".repeat(5000)
    );
    for said in ["", "[]", r#"{"do":"reboot"}"#, r#"{"do":"mark"}"#, &long] {
        let mut bad = Viewer::connect(live.url());
        bad.say(said);
        while bad.next().is_some() {}
    }
    good.find("samples", |_| true);
    live.stop().unwrap();
}

#[test]
fn more_viewers_than_there_is_room_for_are_refused_until_one_leaves() {
    let live = serve(Source::Demo);
    let mut viewers: Vec<_> = (0..16).map(|_| Viewer::connect(live.url())).collect();
    assert_eq!(Viewer::connect_from(live.url(), None).err(), Some(503));
    viewers.pop();
    let end = Instant::now() + Duration::from_secs(10);
    while Viewer::connect_from(live.url(), None).is_err() {
        assert!(Instant::now() < end, "the place is not free");
    }
    live.stop().unwrap();
}

#[test]
fn when_the_program_ends_viewers_are_told_and_the_port_is_free() {
    let live = serve(Source::Demo);
    let url = live.url().to_owned();
    let mut viewer = Viewer::connect(&url);
    viewer.find("samples", |_| true);
    live.stop().unwrap();
    viewer.find("end", |_| true);
    while viewer.next().is_some() {}
    let address = url.trim_start_matches("http://").trim_end_matches('/');
    assert!(std::net::TcpStream::connect(address).is_err());
}
