//! Browser without a window: Chromium over the protocol of its developer tools, Firefox over WebDriver BiDi.

#[path = "browser/chromium.rs"]
mod chromium;
#[path = "browser/firefox.rs"]
mod firefox;

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};
pub use xtask::browser::BrowserKind;

/// Longest wait for a start on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Whether the page shows a label, and whether its source is connected or lost.
pub const VALID: &str = "$valid?.dataset.valid === 'yes'";
pub const CONNECTED: &str = "$source?.dataset.state === 'connected'";
pub const LOST: &str = "$source?.dataset.state === 'lost'";
/// Whether nothing is wider than the window.
pub const FITS: &str = "document.documentElement.scrollWidth <= innerWidth";

/// Keeps what the page saves, for the test to read.
pub const CATCH: &str = "(create => URL.createObjectURL = (blob) => create.call(URL, window.saved = blob))(URL.createObjectURL) && null";

/// Browser with one page.
pub struct Browser {
    kind: BrowserKind,
    child: Child,
    socket: WebSocket<TcpStream>,
    commands: u64,
    /// Firefox's name of the page.
    context: Value,
    /// Exceptions, log entries and console messages of the page.
    pub complaints: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts a browser of a kind. Without it, returns `None` and books the test of this thread as skipped.
    pub fn start(kind: BrowserKind) -> Option<Self> {
        let program = match kind.find() {
            Ok(program) => program,
            Err(error) => {
                myointent_tests::skip(&format!("{error:#}"));
                return None;
            }
        };
        let profile = tempfile::tempdir().unwrap();
        let mut command = Command::new(program);
        match kind {
            BrowserKind::Chromium => chromium::arguments(&mut command, profile.path()),
            BrowserKind::Firefox => firefox::arguments(&mut command, profile.path()),
        }
        let mut child = command
            // A browser that is killed leaves its files, here in a folder that goes.
            .env("TMPDIR", profile.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap());
        let port = port(&mut lines);
        // A full pipe would block the browser.
        std::thread::spawn(move || {
            let _ = std::io::copy(&mut lines, &mut std::io::sink());
        });
        let address = match kind {
            BrowserKind::Chromium => chromium::page(port),
            BrowserKind::Firefox => format!("ws://127.0.0.1:{port}/session"),
        };
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(address, stream).unwrap();
        let mut browser = Self {
            kind,
            child,
            socket,
            commands: 0,
            context: Value::Null,
            complaints: Vec::new(),
            _profile: profile,
        };
        match kind {
            BrowserKind::Chromium => browser.begin_chromium(),
            BrowserKind::Firefox => browser.begin_firefox(),
        }
        Some(browser)
    }

    /// Sends a command and waits for its result.
    pub fn command(&mut self, method: &str, parameters: Value) -> Value {
        let answer = self.answer(method, parameters);
        answer.unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Sends a script and waits for its result: null if the page was left meanwhile.
    fn evaluate(&mut self, method: &str, parameters: Value) -> Value {
        match self.answer(method, parameters) {
            Ok(result) => result,
            Err(error) => {
                let text = error.to_string();
                let is_left = ["navigated", "destroyed"]
                    .iter()
                    .any(|word| text.contains(word));
                assert!(is_left, "{method}: {text}");
                Value::Null
            }
        }
    }

    /// Sends a command and waits for its result, or its error.
    fn answer(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        self.commands += 1;
        let id = self.commands;
        let text = json!({ "id": id, "method": method, "params": parameters }).to_string();
        self.socket.send(Message::text(text)).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else {
                continue;
            };
            let mut message: Value = serde_json::from_str(&text).unwrap();
            if message["id"] == id {
                if !message["error"].is_null() {
                    return Err(message);
                }
                return Ok(message["result"].take());
            }
            let method = message["method"].as_str().unwrap_or_default();
            let parameters = &message["params"];
            match self.kind {
                BrowserKind::Chromium => self
                    .complaints
                    .extend(chromium::complaint(method, parameters)),
                BrowserKind::Firefox => self
                    .complaints
                    .extend(firefox::complaint(method, parameters)),
            }
        }
    }

    /// Goes to an address.
    pub fn open(&mut self, url: &str) {
        match self.kind {
            BrowserKind::Chromium => self.command("Page.navigate", json!({ "url": url })),
            BrowserKind::Firefox => self.navigate_firefox(url),
        };
    }

    /// Returns the value of an expression of the page's script, in which `$id` is the element of that id.
    pub fn value(&mut self, expression: &str) -> Value {
        self.run(&elements(expression))
    }

    /// Returns the value of a script as it is.
    pub fn run(&mut self, expression: &str) -> Value {
        match self.kind {
            BrowserKind::Chromium => self.evaluate_chromium(expression),
            BrowserKind::Firefox => self.evaluate_firefox(expression),
        }
    }

    /// Whether an expression is true.
    pub fn is(&mut self, expression: &str) -> bool {
        self.value(expression) == true
    }

    /// Waits until the page has drawn `count` frames.
    pub fn frames(&mut self, count: u32) {
        self.value(&format!(
            "new Promise(done => {{ let left = {count}; \
             const next = () => left-- > 0 ? requestAnimationFrame(next) : done(true); next(); }})"
        ));
    }

    /// Returns the text of an element.
    pub fn text(&mut self, id: &str) -> String {
        let text = self.value(&format!("${id}?.textContent ?? ''"));
        text.as_str().unwrap().to_owned()
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while !self.is(expression) {
            assert!(
                Instant::now() < end,
                "not within {PATIENCE:?}: {expression}"
            );
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and releases a key.
    pub fn press(&mut self, key: &str) {
        match self.kind {
            BrowserKind::Chromium => self.press_chromium(key),
            BrowserKind::Firefox => self.press_firefox(key),
        }
    }

    /// Sets the size of the window, and the user's preferences.
    pub fn look(&mut self, width: u32, height: u32, scheme: &str, motion: &str) {
        match self.kind {
            BrowserKind::Chromium => self.look_chromium(width, height, scheme, motion),
            BrowserKind::Firefox => self.look_firefox(width, height, scheme, motion),
        }
    }

    /// Writes a picture of Chromium's window.
    pub fn screenshot(&mut self, path: &Path) {
        let result = self.command("Page.captureScreenshot", json!({ "format": "png" }));
        let picture = base64(result["data"].as_str().unwrap());
        std::fs::write(path, picture).unwrap();
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Replaces `$id` by the element of that id.
fn elements(text: &str) -> String {
    let mut parts = text.split('$');
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|letter: char| !(letter.is_ascii_lowercase() || letter == '-'));
        whole += &match part.split_at(end.unwrap_or(part.len())) {
            ("", rest) => format!("${rest}"),
            (id, rest) => format!("document.getElementById('{id}'){rest}"),
        };
    }
    whole
}

/// Reads the port, which the browser prints.
fn port(lines: &mut impl BufRead) -> u16 {
    let mut all = String::new();
    loop {
        let mut line = String::new();
        let length = lines.read_line(&mut line).unwrap();
        assert!(length > 0, "the browser ended: {all}");
        if let Some((_, rest)) = line.split_once(" listening on ws://127.0.0.1:") {
            let digits = rest.split(|letter: char| !letter.is_ascii_digit());
            return digits.take(1).collect::<String>().parse().unwrap();
        }
        all += &line;
    }
}

pub fn base64(text: &str) -> Vec<u8> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits = four
            .iter()
            .fold(0_u32, |bits, &letter| bits << 6 | u32::from(digit(letter)));
        let bits = bits << (6 * (4 - four.len()));
        bytes.extend(&bits.to_be_bytes()[1..four.len()]);
    }
    bytes
}
