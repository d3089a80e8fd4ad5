//! A viewer that does not read, beside a viewer that reads.

use std::net::TcpStream;
use std::sync::mpsc::channel;
use std::time::Duration;

use tungstenite::{Message, WebSocket};

use super::*;
use web::event::Event;

type Socket = WebSocket<TcpStream>;

fn connect(url: &str) -> Socket {
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    let stream = TcpStream::connect(host).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    tungstenite::client(format!("ws://{host}/socket"), stream)
        .unwrap()
        .0
}

/// Reads the marks of a frame, and the number of messages that were skipped.
fn read(socket: &mut Socket) -> (Vec<u64>, u64) {
    let Message::Text(text) = socket.read().unwrap() else {
        panic!("a text");
    };
    let messages: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    let of = |kind: &str, field: &str| {
        let some = messages.iter().filter(|message| message["type"] == kind);
        some.map(|message| message[field].as_u64().unwrap())
            .collect::<Vec<_>>()
    };
    let skipped = of("skipped", "messages");
    (of("mark", "sample"), skipped.into_iter().sum())
}

#[test]
fn a_viewer_that_does_not_read_is_left_behind_and_told_so_and_the_other_misses_nothing() {
    // More messages than the buffers of a local connection hold.
    const MARKS: u32 = 6_000;
    let text = "x".repeat(4_096);

    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let access = Access::new(listener.local_addr().unwrap());
    let url = access.url();
    let hub = Arc::new(Hub::new());
    let (inputs, _kept) = channel();
    let server = Server::start(listener, access, hub.clone(), inputs, None).unwrap();
    let [mut slow, mut fast] = [(); 2].map(|()| connect(&url));
    for socket in [&mut slow, &mut fast] {
        assert_eq!(read(socket), (vec![], 0), "hello");
    }
    let mut next = 0;
    for sample in 0..MARKS {
        let text = text.clone();
        hub.publish(&Event::Mark { sample, text });
        // Reads along closely enough that nothing is skipped.
        while next + 100 <= sample || (sample == MARKS - 1 && next < MARKS) {
            let (marks, skipped) = read(&mut fast);
            assert_eq!(skipped, 0);
            for mark in marks {
                assert_eq!(mark, u64::from(next));
                next += 1;
            }
        }
    }
    let (mut seen, mut skipped, mut last) = (0, 0, None);
    while last != Some(u64::from(MARKS - 1)) {
        let (marks, lost) = read(&mut slow);
        skipped += lost;
        seen += marks.len() as u64;
        last = marks.last().copied().or(last);
        if lost > 0 {
            // One more mark, which the resubscribed viewer receives.
            let sample = MARKS - 1;
            let text = String::new();
            hub.publish(&Event::Mark { sample, text });
        }
    }
    assert!(skipped > 0 && seen < u64::from(MARKS), "{seen}, {skipped}");
    server.stop();
}
