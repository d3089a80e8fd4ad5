//! A scenario's file.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use serde::Deserialize;
use toml::{Table, Value};

use super::expectation::Expectation;

/// One scenario: what armband, person and board do, and what has to come of it. README.md describes the keys.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What it shows, in one sentence.
    pub about: String,
    /// Seconds of EMG.
    pub seconds: f64,
    /// The recording that they are taken from, in the folder of recordings; without one they are noise.
    pub recording: Option<PathBuf>,
    /// What it is without a recording.
    #[serde(default)]
    pub signal: Signal,
    /// What the model's region holds.
    #[serde(default)]
    pub model: Model,
    /// What the page of the bound armband holds.
    #[serde(default)]
    pub page: Page,
    /// Why only the simulated board runs it.
    pub simulation_only: Option<String>,
    /// How many times slower than real time the emulated board's clock runs.
    pub time_scale: Option<u32>,
    /// Whether the emulated board gets the armband's rate by its own clock.
    #[serde(default)]
    pub true_rate: bool,
    /// What has to come of it.
    pub expect: Expectation,

    // For the board's surroundings; firmware/src/board/simulated/scenario.rs has their types.
    #[serde(rename = "run_seconds")]
    _run_seconds: Value,
    /// What follows the last sample.
    #[serde(default = "silence")]
    pub end: String,
    /// How many times faster than an armband it streams.
    #[serde(default = "as_an_armband")]
    pub pace: f64,
    /// The EMG characteristic that a stream starts with.
    #[serde(default)]
    pub first_lane: u8,
    /// What the armband does wrong.
    #[serde(default)]
    pub armband: Vec<Table>,
    /// Another armband.
    pub stranger: Option<Stranger>,
    /// What a person does.
    #[serde(default)]
    pub person: Vec<Act>,
    /// What goes wrong on the board.
    pub fault: Option<String>,
    #[serde(rename = "interval_ms")]
    _interval_ms: Option<Value>,
    #[serde(rename = "packet_ms")]
    _packet_ms: Option<Value>,
    #[serde(rename = "page_fails")]
    _page_fails: Option<Value>,
    #[serde(rename = "power_fails_at")]
    _power_fails_at: Option<Value>,
    #[serde(rename = "power_fails_done")]
    _power_fails_done: Option<Value>,
    /// The model that a person installs: a file of `models` without `.intent`.
    pub install: Option<String>,
}

const fn as_an_armband() -> f64 {
    1.0
}

fn silence() -> String {
    "silence".to_owned()
}

/// Synthetic EMG.
#[derive(Deserialize, Clone, Copy, Default, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Signal {
    /// Rest and effort in turn, 1.5 s each.
    #[default]
    Effort,
    /// Rest.
    Rest,
    /// As effort, from electrodes that are all at their limit.
    Saturated,
    /// The same value all the time.
    Constant,
}

/// What the model's region holds.
#[derive(Deserialize, Clone, Default, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The model of the README.
    #[default]
    Shipped,
    /// Nothing: erased flash.
    Erased,
    /// The first half of it.
    Half,
    /// It with a bit of a weight changed.
    FlippedBit,
    /// It with another format version.
    AnotherVersion,
}

/// What the page of the bound armband holds.
#[derive(Deserialize, Clone, Copy, Default, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Page {
    /// The armband of the scenario.
    #[default]
    Bound,
    /// Nothing: erased flash.
    Erased,
    /// A record without the checksum.
    HalfWritten,
    /// A record with a bit of the address changed.
    FlippedBit,
}

/// Another armband.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
pub struct Stranger {
    /// A public one.
    pub address: String,
    /// Strength of its signal, dBm; the armband's own is -50.
    pub rssi: i8,
}

/// What a person does, once as many notifications were sent as `at` says.
#[derive(Deserialize, Clone)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Act {
    /// Presses the button.
    Press {
        /// Notifications before.
        at: usize,
        /// Milliseconds until it is released.
        for_ms: u64,
    },
    /// Sends a line.
    Send {
        /// Notifications before.
        at: usize,
        /// Its body.
        command: String,
    },
    /// Sends bytes.
    SendBytes {
        /// Notifications before.
        at: usize,
        /// Each character is a byte.
        text: String,
        /// How often.
        #[serde(default = "once")]
        times: usize,
    },
    /// Installs a model: on the simulated board alone.
    Install {
        /// Notifications before.
        at: usize,
        #[serde(default, rename = "pulled_after")]
        _pulled_after: Vec<u32>,
        #[serde(default, rename = "pulled_byte")]
        _pulled_byte: Vec<usize>,
        #[serde(default, rename = "pulled_ms")]
        _pulled_ms: Option<u64>,
    },
}

const fn once() -> usize {
    1
}

/// A file and what it says.
#[derive(Clone)]
pub struct File {
    /// Its name without `.toml`.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// What it says, with every step that is repeated written out.
    pub text: String,
    /// The same.
    pub scenario: Scenario,
}

/// All scenarios of a folder, by name.
///
/// # Errors
/// When a file cannot be read, or is none.
pub fn all(folder: &Path) -> anyhow::Result<Vec<File>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            files.push(read(path)?);
        }
    }
    files.sort_by(|one, next| one.name.cmp(&next.name));
    Ok(files)
}

fn read(path: PathBuf) -> anyhow::Result<File> {
    let shown = path.display().to_string();
    let text = std::fs::read_to_string(&path).with_context(|| shown.clone())?;
    let mut table: Table = toml::from_str(&text).with_context(|| shown.clone())?;
    if let Some(Value::Array(steps)) = table.get_mut("armband") {
        *steps = steps.drain(..).flat_map(written_out).collect();
    }
    let text = toml::to_string(&table)?;
    let scenario: Scenario = table.try_into().with_context(|| shown.clone())?;
    ensure!(
        scenario.expect.checks_something(),
        "{shown}: it expects nothing"
    );
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(File {
        name: name.into_owned(),
        path,
        text,
        scenario,
    })
}

/// A step that has `times` and `every`, as many.
fn written_out(step: Value) -> Vec<Value> {
    let Value::Table(mut step) = step else {
        return vec![step];
    };
    let times = step.remove("times").and_then(|times| times.as_integer());
    let every = step.remove("every").and_then(|every| every.as_integer());
    let first = step.get("at").and_then(Value::as_integer);
    let (Some(times), Some(every), Some(first)) = (times, every, first) else {
        return vec![step.into()];
    };
    let one = |number| {
        let mut one = step.clone();
        one.insert("at".to_owned(), Value::Integer(first + number * every));
        one.into()
    };
    (0..times).map(one).collect()
}
