//! File of a scenario.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use serde::Deserialize;
use toml::{Table, Value};

use super::expectation::Expectation;

/// Scenario: actions of armband, person and board, and the expected result. README.md describes the keys.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Sentence about what the scenario shows.
    pub about: String,
    /// Seconds of EMG.
    pub seconds: f64,
    /// Recording from which the samples are taken, in the folder of recordings; without one they are rest and effort in turn,
    /// 1.5 s each.
    pub recording: Option<PathBuf>,
    /// Content of the model's region.
    #[serde(default)]
    pub model: Content,
    /// Content of the page of the bound armband.
    #[serde(default)]
    pub page: Content,
    /// Reason why the emulated chip does not run it.
    pub not_on_chip: Option<String>,
    /// True if the emulated chip runs it in every run of the tests; the others with `--ignored`.
    #[serde(default)]
    pub always_on_chip: bool,
    /// True if the image without a SoftDevice runs it on the chip too.
    #[serde(default)]
    pub on_sdc: bool,
    /// Expected result.
    pub expect: Expectation,
    /// Model that a person installs: a file of `models` without `.intent`.
    pub install: Option<String>,
    /// Part that the board's surroundings carry out.
    #[serde(flatten)]
    pub surroundings: virtual_armband::Scenario,
}

/// Content of a region of flash.
#[derive(Deserialize, Clone, Copy, Default, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Content {
    /// Model of the README, or record of the scenario's armband.
    #[default]
    Written,
    /// Erased flash.
    Erased,
}

/// File of a scenario, read.
#[derive(Clone)]
pub struct File {
    /// Name of the file without `.toml`.
    pub name: String,
    pub path: PathBuf,
    /// Text of the file, with every repeated step written out.
    pub text: String,
    /// Scenario of this text.
    pub scenario: Scenario,
}

/// Reads all scenarios of a folder, by name.
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

/// Repeats a step that has `times` and `every`.
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
