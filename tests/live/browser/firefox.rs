//! Firefox, over WebDriver BiDi, which it speaks without another program.

use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use super::Browser;

/// Preferences: a light page that moves, in English.
const PREFERENCES: &str = r#"user_pref("layout.css.prefers-color-scheme.content-override", 1);
user_pref("ui.prefersReducedMotion", 0);
user_pref("intl.accept_languages", "en-US");
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
"#;

/// Adds the arguments of a start.
pub(super) fn arguments(command: &mut Command, profile: &Path) {
    std::fs::write(profile.join("user.js"), PREFERENCES).unwrap();
    command
        .args(["--headless", "--no-remote", "--remote-debugging-port=0"])
        .arg("--profile")
        .arg(profile)
        .arg("about:blank");
}

/// Returns what an event of the page complains about.
pub(super) fn complaint(method: &str, parameters: &Value) -> Option<String> {
    (method == "log.entryAdded").then(|| parameters.to_string())
}

impl Browser {
    pub(super) fn begin_firefox(&mut self) {
        self.command("session.new", json!({ "capabilities": {} }));
        let mut tree = self.command("browsingContext.getTree", json!({}));
        self.context = tree["contexts"][0]["context"].take();
        self.command(
            "session.subscribe",
            json!({ "events": ["log.entryAdded"], "contexts": [self.context] }),
        );
    }

    pub(super) fn navigate_firefox(&mut self, url: &str) -> Value {
        let parameters = json!({ "context": self.context, "url": url, "wait": "interactive" });
        self.command("browsingContext.navigate", parameters)
    }

    pub(super) fn evaluate_firefox(&mut self, expression: &str) -> Value {
        let whole = format!("(async () => JSON.stringify({{ value: await ({expression}) }}))()");
        let parameters = json!({
            "expression": whole, "target": { "context": self.context }, "awaitPromise": true, "userActivation": true,
        });
        let result = self.evaluate("script.evaluate", parameters);
        if result.is_null() {
            return result;
        }
        assert_eq!(result["type"], "success", "{expression}: {result}");
        let text = result["result"]["value"].as_str().unwrap();
        serde_json::from_str::<Value>(text).unwrap()["value"].take()
    }

    pub(super) fn press_firefox(&mut self, key: &str) {
        let value = match key {
            "Enter" => "\u{e007}",
            "Escape" => "\u{e00c}",
            "ArrowLeft" => "\u{e012}",
            "ArrowRight" => "\u{e014}",
            letter => letter,
        };
        let actions = ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": value }));
        let keyboard = json!([{ "type": "key", "id": "keyboard", "actions": actions }]);
        let parameters = json!({ "context": self.context, "actions": keyboard });
        self.command("input.performActions", parameters);
    }

    /// Sets the size; scheme and motion are preferences of the start.
    pub(super) fn look_firefox(&mut self, width: u32, height: u32, scheme: &str, motion: &str) {
        assert_eq!((scheme, motion), ("light", "no-preference"));
        let size = json!({ "width": width, "height": height });
        let parameters =
            json!({ "context": self.context, "viewport": size, "devicePixelRatio": 1 });
        self.command("browsingContext.setViewport", parameters);
    }
}
