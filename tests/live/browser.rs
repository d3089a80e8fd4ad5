//! Browser without a window, driven over the protocol of its developer tools.

use std::io::{BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};
use xtask::browser;

/// Longest wait for a start on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Browser with one page.
pub struct Browser {
    child: Child,
    socket: WebSocket<TcpStream>,
    commands: u64,
    /// Exceptions, log entries and console messages of the page.
    pub complaints: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts the browser. Without a browser, returns `None` and books the test `name` as skipped.
    pub fn start(name: &str) -> Option<Self> {
        let program = match browser::find() {
            Ok(program) => program,
            Err(error) => {
                myointent_tests::skip(name, &format!("{error:#}"));
                return None;
            }
        };
        let profile = tempfile::tempdir().unwrap();
        let mut child = Command::new(program)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu"])
            .args([
                "--no-first-run",
                "--disable-dev-shm-usage",
                "--hide-scrollbars",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
            ])
            .arg("--remote-debugging-port=0")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
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
        let address = page(port);
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(address, stream).unwrap();
        let mut browser = Self {
            child,
            socket,
            commands: 0,
            complaints: Vec::new(),
            _profile: profile,
        };
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.command(domain, json!({}));
        }
        Some(browser)
    }

    /// Sends a command and waits for its result.
    pub fn command(&mut self, method: &str, parameters: Value) -> Value {
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
                assert!(message["error"].is_null(), "{method}: {message}");
                return message["result"].take();
            }
            let parameters = &message["params"];
            match message["method"].as_str() {
                Some("Runtime.exceptionThrown") => self.complaints.push(parameters.to_string()),
                Some("Log.entryAdded") => {
                    let entry = &parameters["entry"];
                    // Advice on speed comes from reading the picture back, which the tests do and the page does not.
                    if entry["level"] != "verbose" && entry["source"] != "rendering" {
                        self.complaints.push(entry.to_string());
                    }
                }
                Some("Runtime.consoleAPICalled") => self.complaints.push(parameters.to_string()),
                _ => {}
            }
        }
    }

    /// Goes to an address.
    pub fn open(&mut self, url: &str) {
        self.command("Page.navigate", json!({ "url": url }));
    }

    /// Returns the value of an expression of the page's script.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut result = self.command("Runtime.evaluate", parameters);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].take()
    }

    /// Waits until the page has drawn so many frames.
    pub fn frames(&mut self, count: u32) {
        self.value(&format!(
            "new Promise(done => {{ let left = {count}; \
             const next = () => left-- > 0 ? requestAnimationFrame(next) : done(true); next(); }})"
        ));
    }

    /// Returns the text of an element.
    pub fn text(&mut self, id: &str) -> String {
        let text = self.value(&format!(
            "document.getElementById('{id}')?.textContent ?? ''"
        ));
        text.as_str().unwrap().to_owned()
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while self.value(expression) != true {
            assert!(
                Instant::now() < end,
                "not within {PATIENCE:?}: {expression}"
            );
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and releases a key.
    pub fn press(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            let text = if key.len() == 1 { key } else { "" };
            let parameters = json!({ "type": kind, "key": key, "text": if kind == "keyDown" { text } else { "" } });
            self.command("Input.dispatchKeyEvent", parameters);
        }
    }

    /// Sets the size of the window, and the user's preferences.
    pub fn look(&mut self, width: u32, height: u32, scheme: &str, motion: &str) {
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.command("Emulation.setDeviceMetricsOverride", metrics);
        let features = json!({ "features": [
            { "name": "prefers-color-scheme", "value": scheme },
            { "name": "prefers-reduced-motion", "value": motion },
        ] });
        self.command("Emulation.setEmulatedMedia", features);
    }

    /// Writes a picture of the window.
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

/// Reads the port of the developer tools, which the browser prints.
fn port(lines: &mut impl std::io::BufRead) -> u16 {
    let mut all = String::new();
    loop {
        let mut line = String::new();
        let length = lines.read_line(&mut line).unwrap();
        assert!(length > 0, "the browser ended: {all}");
        if let Some((_, rest)) = line.split_once("DevTools listening on ws://127.0.0.1:") {
            return rest.split_once('/').unwrap().0.parse().unwrap();
        }
        all += &line;
    }
}

/// Returns the address of the page's websocket.
fn page(port: u16) -> String {
    let end = Instant::now() + PATIENCE;
    loop {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let request =
            format!("GET /json HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(2)))
            .unwrap();
        let mut answer = Vec::new();
        // The browser may keep the connection open: what has come is enough.
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
        let targets: Vec<Value> = serde_json::from_str(body).unwrap_or_default();
        let found = targets.iter().find(|target| target["type"] == "page");
        if let Some(page) = found {
            return page["webSocketDebuggerUrl"].as_str().unwrap().to_owned();
        }
        assert!(Instant::now() < end, "the browser opens no page: {answer}");
        std::thread::sleep(Duration::from_millis(100));
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
