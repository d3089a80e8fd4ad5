//! What a terminal shows, kept from the messages that every viewer is told.

use std::collections::VecDeque;

use serde_json::Value;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

/// Samples in view: 3 s.
pub(super) const IN_VIEW: usize = 3 * SAMPLE_RATE_HZ as usize;

/// What is known of the stream.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// The newest samples; none where one is missing.
    pub(super) samples: VecDeque<Option<[f64; CHANNELS]>>,
    next: Option<u64>,
    pub(super) source: String,
    pub(super) connected: bool,
    pub(super) label: Option<String>,
    /// Of the safe state.
    pub(super) cause: Option<String>,
    /// Samples from the instant of the newest label to its emission.
    pub(super) delay: Option<u64>,
    pub(super) lost: u64,
    pub(super) truth: Option<String>,
    /// Names of the classes, and of other movement if the model knows it.
    pub(super) classes: Vec<String>,
    pub(super) scores: Vec<f64>,
    pub(super) battery: Option<u64>,
    pub(super) alignment: Option<String>,
    /// Of the board, a mark, or the program.
    pub(super) comment: String,
}

impl Seen {
    /// Takes a message.
    pub(super) fn take(&mut self, message: &str) {
        let Ok(message) = serde_json::from_str::<Value>(message) else {
            return;
        };
        let text = |field: &str| message[field].as_str().map(str::to_owned);
        match message["type"].as_str() {
            Some("source") => {
                self.connected = message["connected"] == true;
                let words = ["kind", "name", "detail"].map(|field| text(field).unwrap_or_default());
                self.source = words.join(" ").trim_end().to_owned();
                if !self.connected {
                    self.label = None;
                    self.scores.clear();
                }
            }
            Some("model") => {
                let classes = message["classes"].as_array().into_iter().flatten();
                let classes = classes.filter_map(Value::as_str).map(str::to_owned);
                let other = message["other"] == true;
                self.classes = classes.chain(other.then(|| "other".to_owned())).collect();
            }
            Some("samples") => self.samples(&message),
            Some("report") => {
                self.label = text("label");
                self.cause = text("cause");
                self.lost = message["lost"].as_u64().unwrap_or(0);
                if message["is_label"] == true {
                    let [emitted, instant] = ["emitted", "instant"].map(|at| message[at].as_u64());
                    self.delay = emitted
                        .zip(instant)
                        .map(|(end, start)| end.saturating_sub(start));
                }
            }
            Some("scores") => {
                let scores = message["scores"].as_array().into_iter().flatten();
                self.scores = scores.filter_map(Value::as_f64).collect();
            }
            Some("board") => self.battery = message["battery"].as_u64(),
            Some("alignment") => {
                let state = text("state").unwrap_or_default();
                let mirrored = if message["mirrored"] == true {
                    ", mirrored"
                } else {
                    ""
                };
                let turn = message["turn"].as_u64().unwrap_or(0);
                self.alignment = Some(format!("{state}; turn {turn}{mirrored}"));
            }
            Some("mark" | "comment") => self.comment = text("text").unwrap_or_default(),
            _ => {}
        }
    }

    fn samples(&mut self, message: &Value) {
        let Some(first) = message["first"].as_u64() else {
            return;
        };
        match self.next.map(|next| first.checked_sub(next)) {
            Some(Some(missing)) => {
                for _ in 0..missing.min(IN_VIEW as u64) {
                    self.samples.push_back(None);
                }
            }
            // Another stream.
            None | Some(None) => self.samples.clear(),
        }
        let samples = message["emg"].as_array().into_iter().flatten();
        let before = self.samples.len();
        self.samples.extend(samples.map(|sample| {
            let value = |channel: usize| sample[channel].as_f64().unwrap_or(0.0);
            Some(std::array::from_fn(value))
        }));
        self.next = Some(first.saturating_add((self.samples.len() - before) as u64));
        while self.samples.len() > IN_VIEW {
            self.samples.pop_front();
        }
        let newest = message["truth"].as_array().and_then(|truth| truth.last());
        self.truth = newest.map(|truth| truth.as_str().unwrap_or("none").to_owned());
    }

    /// Index of the sample after the newest.
    pub(super) fn end(&self) -> u64 {
        self.next.unwrap_or(0)
    }
}
