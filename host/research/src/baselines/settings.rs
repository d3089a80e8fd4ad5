//! Training settings of the baselines: the table `[baselines]` of a preset file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use execution::bounded_read;
use presets::{BUILT_IN, Preset, PresetError};

/// Name and text of the research preset: preset `cpu` with settings for the baselines.
const OWN: (&str, &str) = ("comparison", include_str!("../../presets/comparison.toml"));
/// Name of the table in a preset file, which the product does not know.
const TABLE: &str = "baselines";

/// Training settings of all baselines; the defaults are the reference's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct BaselineSettings {
    /// Samples between the ends of consecutive training windows.
    pub(crate) stride: usize,
    /// Number of passes over all training windows.
    pub(crate) epochs: usize,
    /// Number of windows per optimizer step.
    pub(crate) batch: usize,
    /// Constant learning rate.
    pub(crate) learning_rate: f64,
    /// Decoupled weight decay of every parameter.
    pub(crate) weight_decay: f32,
    /// Samples between consecutive LSTM time steps, 1 to 500. The reference's 1 makes 500 time steps per
    /// window, ten times the work of 10.
    pub(crate) lstm_step: usize,
}

impl Default for BaselineSettings {
    fn default() -> Self {
        Self {
            stride: 30,
            epochs: 12,
            batch: 128,
            learning_rate: 1e-4,
            weight_decay: 0.01,
            lstm_step: 1,
        }
    }
}

/// Why a preset has no usable settings.
#[derive(Debug, Error)]
pub(crate) enum SettingsError {
    /// The name is neither a built-in preset nor a file.
    #[error("preset {name}: no built-in preset of that name (there are {known}) and no such file")]
    Missing {
        /// Name as given.
        name: String,
        /// Built-in names.
        known: String,
    },
    /// The file cannot be read.
    #[error("preset {path}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not TOML.
    #[error("preset {name}: {reason}")]
    Syntax {
        /// Name of the preset.
        name: String,
        /// Message of the parser.
        reason: toml::de::Error,
    },
    /// The table `[baselines]` has an unknown key or a value of the wrong type.
    #[error("preset {name}: [baselines]: {reason}")]
    Table {
        /// Name of the preset.
        name: String,
        /// Message of the parser.
        reason: toml::de::Error,
    },
    /// A number of the table is out of range.
    #[error("preset {name}: baselines.{key} is {found}, expected {expected}")]
    Value {
        /// Name of the preset.
        name: String,
        /// The key.
        key: &'static str,
        /// Value in the file.
        found: usize,
        /// Allowed range.
        expected: &'static str,
    },
    /// The rest of the preset is invalid.
    #[error(transparent)]
    Preset(#[from] PresetError),
}

/// Finds a preset and its baseline settings: `comparison`, a preset of the product, or a TOML file. Without a
/// table `[baselines]`, the settings are the reference's.
///
/// # Errors
/// When there is no such preset, a key is unknown or a number is out of range.
pub(crate) fn find_preset(name: &str) -> Result<(Preset, BaselineSettings), SettingsError> {
    let built_in = || std::iter::once(&OWN).chain(&BUILT_IN);
    if let Some((_, text)) = built_in().find(|(known, _)| *known == name) {
        return parse(name, text);
    }
    if !Path::new(name).exists() {
        let known: Vec<&str> = built_in().map(|(known, _)| *known).collect();
        return Err(SettingsError::Missing {
            name: name.to_owned(),
            known: known.join(", "),
        });
    }
    let text =
        bounded_read::read_text(Path::new(name), bounded_read::PRESET).map_err(|source| {
            SettingsError::Read {
                path: name.into(),
                source,
            }
        })?;
    parse(name, &text)
}

fn parse(name: &str, text: &str) -> Result<(Preset, BaselineSettings), SettingsError> {
    let mut tables: toml::Table = text.parse().map_err(|reason| SettingsError::Syntax {
        name: name.to_owned(),
        reason,
    })?;
    let settings = match tables.remove(TABLE) {
        None => BaselineSettings::default(),
        Some(table) => table.try_into().map_err(|reason| SettingsError::Table {
            name: name.to_owned(),
            reason,
        })?,
    };
    settings.check(name)?;
    Ok((Preset::parse(name, &tables.to_string())?, settings))
}

impl BaselineSettings {
    fn check(&self, name: &str) -> Result<(), SettingsError> {
        const POSITIVE: (std::ops::RangeInclusive<usize>, &str) = (1..=usize::MAX, "1 or more");
        for (key, found, (range, expected)) in [
            ("stride", self.stride, POSITIVE),
            ("epochs", self.epochs, POSITIVE),
            ("batch", self.batch, POSITIVE),
            ("lstm_step", self.lstm_step, (1..=500, "1 to 500")),
        ] {
            if !range.contains(&found) {
                return Err(SettingsError::Value {
                    name: name.to_owned(),
                    key,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comparison_is_the_recipe_of_the_shipped_models() {
        let (mut comparison, settings) = find_preset("comparison").unwrap();
        assert_ne!(settings, BaselineSettings::default());
        assert_eq!(find_preset("paper").unwrap().1, BaselineSettings::default());
        comparison.name = "cpu".to_owned();
        assert_eq!(comparison, find_preset("cpu").unwrap().0);
    }

    #[test]
    fn an_unknown_preset_is_refused_with_the_known_names() {
        let error = find_preset("nonsense").unwrap_err().to_string();
        assert!(error.contains("comparison, quickstart"), "{error}");
    }

    #[test]
    fn settings_out_of_range_and_unknown_keys_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |table: &str| {
            let path = folder.path().join("mine.toml");
            let rest = OWN.1.split("[baselines]").next().unwrap();
            std::fs::write(&path, format!("{rest}\n[baselines]\n{table}\n")).unwrap();
            find_preset(path.to_str().unwrap()).unwrap_err().to_string()
        };
        assert!(refused("lstm_step = 0").contains("1 to 500"));
        assert!(refused("stride = 0").contains("stride"));
        assert!(refused("nonsense = 1").contains("nonsense"));
    }
}
