//! Chromium, over the protocol of its developer tools.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{Browser, PATIENCE};

/// Adds the arguments of a start.
pub(super) fn arguments(command: &mut Command, profile: &Path) {
    command
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
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg("about:blank");
}

/// Returns the address of the page's websocket.
pub(super) fn page(port: u16) -> String {
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

/// Returns what an event of the page complains about.
pub(super) fn complaint(method: &str, parameters: &Value) -> Option<String> {
    match method {
        "Runtime.exceptionThrown" | "Runtime.consoleAPICalled" => Some(parameters.to_string()),
        "Log.entryAdded" => {
            let entry = &parameters["entry"];
            // Advice on speed comes from reading the picture back, which the tests do and the page does not.
            let is_advice = entry["level"] == "verbose" || entry["source"] == "rendering";
            (!is_advice).then(|| entry.to_string())
        }
        _ => None,
    }
}

impl Browser {
    pub(super) fn begin_chromium(&mut self) {
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            self.command(domain, json!({}));
        }
    }

    pub(super) fn evaluate_chromium(&mut self, expression: &str) -> Value {
        let parameters =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut result = self.evaluate("Runtime.evaluate", parameters);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].take()
    }

    pub(super) fn press_chromium(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            let text = if key.len() == 1 { key } else { "" };
            let parameters = json!({ "type": kind, "key": key, "text": if kind == "keyDown" { text } else { "" } });
            self.command("Input.dispatchKeyEvent", parameters);
        }
    }

    pub(super) fn look_chromium(&mut self, width: u32, height: u32, scheme: &str, motion: &str) {
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.command("Emulation.setDeviceMetricsOverride", metrics);
        let features = json!({ "features": [
            { "name": "prefers-color-scheme", "value": scheme },
            { "name": "prefers-reduced-motion", "value": motion },
        ] });
        self.command("Emulation.setEmulatedMedia", features);
    }
}
