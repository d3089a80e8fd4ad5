//! Viewer without a browser: HTTP and a websocket.

use std::collections::VecDeque;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::Value;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::handshake::HandshakeError;
use tungstenite::{Message, WebSocket};

/// Longest wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Websocket of the page.
pub struct Viewer {
    socket: WebSocket<TcpStream>,
    waiting: VecDeque<Value>,
}

/// Splits a page's address into host and port, and its path.
fn parts(url: &str) -> (&str, &str) {
    let rest = url.strip_prefix("http://").unwrap();
    let slash = rest.find('/').unwrap();
    rest.split_at(slash)
}

/// Connects to the server of a page, without a request.
pub fn dial(url: &str) -> TcpStream {
    let host = url.strip_prefix("http://").unwrap_or(url);
    let host = host.split('/').next().unwrap();
    let stream = TcpStream::connect(host.replace("0.0.0.0", "127.0.0.1")).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream
}

/// Sends a request with this method, path and headers; returns the status and all that follows it.
pub fn request(url: &str, method: &str, path: &str, headers: &str) -> (u16, String) {
    let mut stream = dial(parts(url).0);
    let request = format!("{method} {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
    (status, answer)
}

/// Sends a request for a file as a browser does; returns the status and all that follows it.
pub fn get(url: &str, file: &str) -> (u16, String) {
    let (host, path) = parts(url);
    let path = format!("{path}{file}");
    request(url, "GET", &path, &format!("Host: {host}\r\n"))
}

impl Viewer {
    /// Connects a viewer to the page at `url`.
    pub fn connect(url: &str) -> Self {
        Self::connect_from(url, None).unwrap()
    }

    /// Connects a viewer whose page has this origin; fails with the status of the refusal.
    pub fn connect_from(url: &str, origin: Option<&str>) -> Result<Self, u16> {
        let (host, path) = parts(url);
        let address = format!("ws://{host}{path}socket");
        let mut request = address.into_client_request().unwrap();
        if let Some(origin) = origin {
            let origin = origin.parse().unwrap();
            request.headers_mut().insert("Origin", origin);
        }
        match tungstenite::client(request, dial(host)) {
            Ok((socket, _)) => Ok(Self {
                socket,
                waiting: VecDeque::new(),
            }),
            Err(HandshakeError::Failure(tungstenite::Error::Http(answer))) => {
                Err(answer.status().as_u16())
            }
            Err(error) => panic!("{error}"),
        }
    }

    /// Returns the next message; `None` once the program has closed the connection.
    pub fn next(&mut self) -> Option<Value> {
        while self.waiting.is_empty() {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let messages: Vec<Value> = serde_json::from_str(&text).unwrap();
                    self.waiting.extend(messages);
                }
                Ok(Message::Close(_)) | Err(_) => return None,
                Ok(_) => {}
            }
        }
        self.waiting.pop_front()
    }

    /// Returns the next message of a type for which `is_wanted` holds.
    pub fn find(&mut self, kind: &str, is_wanted: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            let message = self.next().expect("a message, not the end");
            if message["type"] == kind && is_wanted(&message) {
                return message;
            }
        }
        panic!("no such message of type {kind} within {PATIENCE:?}");
    }

    /// Sends a message.
    pub fn say(&mut self, message: &str) {
        self.socket.send(Message::text(message)).unwrap();
    }
}
