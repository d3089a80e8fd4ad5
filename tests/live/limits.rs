//! Limits on viewers and connections, so that they take nothing from the others.

use std::time::{Duration, Instant};

use myointent::live::Source;

use super::serve;
use super::viewer::{Viewer, dial, get};

#[test]
fn marks_of_one_viewer_without_end_take_nothing_from_the_others() {
    const MARKS: usize = 20_000;
    let live = serve(Source::Demo);
    let mut other = Viewer::connect(live.url());
    other.find("samples", |_| true);
    let url = live.url().to_owned();
    let flood = std::thread::spawn(move || {
        let mut viewer = Viewer::connect(&url);
        for sample in 0..MARKS {
            viewer.say(&format!(
                r#"{{"do":"mark","sample":{sample},"text":"flood"}}"#
            ));
        }
        viewer
    });
    let (mut marks, mut samples, mut next) = (0, 0, None);
    while samples < 600 {
        let message = other.next().unwrap();
        match message["type"].as_str().unwrap() {
            "skipped" => panic!("{message}"),
            "mark" => marks += usize::from(message["text"] == "flood"),
            "samples" => {
                let first = message["first"].as_u64().unwrap();
                assert!(
                    next.is_none_or(|next| next == first),
                    "{first}, not {next:?}"
                );
                next = Some(first + 2);
                samples += 1;
                if samples == 200 {
                    other.say(r#"{"do":"mark","sample":1,"text":"mine"}"#);
                }
            }
            _ => {}
        }
    }
    assert!((1..200).contains(&marks), "{marks}");
    let mut flood = flood.join().unwrap();
    let told = flood.find("refused", |message| message["do"] == "mark");
    assert!(
        told["text"].as_str().unwrap().contains("a second"),
        "{told}"
    );
    live.stop().unwrap();
}

#[test]
fn a_mark_of_another_viewer_is_shown_while_one_floods() {
    let live = serve(Source::Demo);
    let mut other = Viewer::connect(live.url());
    let mut flood = Viewer::connect(live.url());
    for sample in 0..2_000 {
        flood.say(&format!(
            r#"{{"do":"mark","sample":{sample},"text":"flood"}}"#
        ));
    }
    other.say(r#"{"do":"mark","sample":1,"text":"mine"}"#);
    let began = Instant::now();
    other.find("mark", |message| message["text"] == "mine");
    assert!(began.elapsed() < Duration::from_secs(5), "{began:?}");
    // Requests for an alignment are limited too.
    for _ in 0..2_000 {
        flood.say(r#"{"do":"cancel"}"#);
    }
    other.say(r#"{"do":"align"}"#);
    other.find("alignment", |message| message["state"] == "waiting");
    live.stop().unwrap();
}

/// Returns the time for which a connection stays open that is sent `bytes`, one at a time.
fn stays(url: &str, bytes: &[u8]) -> Duration {
    use std::io::{ErrorKind, Read as _, Write as _};

    let began = Instant::now();
    let mut stream = dial(url);
    stream
        .set_read_timeout(Some(Duration::from_millis(200)))
        .unwrap();
    let mut bytes = bytes.iter().cycle();
    while began.elapsed() < Duration::from_secs(60) {
        if let Some(byte) = bytes.next()
            && stream.write_all(&[*byte]).is_err()
        {
            break;
        }
        match stream.read(&mut [0; 256]) {
            Ok(0) => break,
            Ok(_) => {}
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => break,
        }
    }
    began.elapsed()
}

#[test]
fn connections_without_number_or_without_end_are_closed_and_viewers_stay() {
    std::thread::scope(|scope| {
        scope.spawn(closes_what_never_ends);
        refuses_what_is_without_number();
    });
}

/// Checks that connections are closed that ask for nothing, or never end their request.
fn closes_what_never_ends() {
    let live = serve(Source::Demo);
    let url = live.url().to_owned();
    let mut viewer = Viewer::connect(&url);
    let slow = [&b""[..], b"GET / HTTP/1.1\r\nX: ", b"x"];
    std::thread::scope(|scope| {
        for bytes in slow {
            let url = &url;
            scope.spawn(move || {
                let stayed = stays(url, bytes);
                assert!(stayed < Duration::from_secs(45), "{stayed:?}");
            });
        }
    });
    // A viewer may stay for any time without saying anything.
    viewer.find("samples", |_| true);
    live.stop().unwrap();
}

/// Checks that connections are refused that are too many.
fn refuses_what_is_without_number() {
    let live = serve(Source::Demo);
    let mut viewer = Viewer::connect(live.url());
    let began = Instant::now();
    let idle: Vec<_> = (0..400).map(|_| dial(live.url())).collect();
    let closed = |stream: &std::net::TcpStream| {
        use std::io::Read as _;
        let wait = Duration::from_millis(10);
        stream.set_read_timeout(Some(wait)).unwrap();
        let mut stream = stream;
        match stream.read(&mut [0]) {
            Ok(length) => length == 0,
            Err(error) => error.kind() == std::io::ErrorKind::ConnectionReset,
        }
    };
    let end = began + Duration::from_secs(10);
    while idle.iter().filter(|stream| !closed(stream)).count() > 256 {
        assert!(Instant::now() < end, "more than 256 are open");
    }
    viewer.find("samples", |message| {
        message["first"].as_u64().unwrap() > 400
    });
    // The page answers again once the idle connections are closed.
    let end = Instant::now() + Duration::from_secs(60);
    while idle.iter().any(|stream| !closed(stream)) {
        assert!(Instant::now() < end, "after {:?}", began.elapsed());
    }
    assert_eq!(get(live.url(), "").0, 200);
    live.stop().unwrap();
}

#[test]
fn more_viewers_than_there_is_room_for_are_refused_until_one_leaves() {
    let live = serve(Source::Demo);
    let mut viewers: Vec<_> = (0..16).map(|_| Viewer::connect(live.url())).collect();
    assert_eq!(Viewer::connect_from(live.url(), None).err(), Some(503));
    viewers.pop();
    let end = std::time::Instant::now() + std::time::Duration::from_secs(10);
    while Viewer::connect_from(live.url(), None).is_err() {
        assert!(std::time::Instant::now() < end, "the place is not free");
    }
    live.stop().unwrap();
}
