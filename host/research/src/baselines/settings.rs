//! How the baselines are trained, and where it is written.

use std::path::Path;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use myointent::run::preset::{Preset, PresetError};

/// The preset of the paper's comparisons, baselines included.
const STUDY: (&str, &str) = ("study", include_str!("../../presets/study.toml"));
/// The table of a preset file that the product knows nothing of.
const TABLE: &str = "baselines";

/// How baselines are trained; the defaults are the reference's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BaselineSettings {
    /// Samples between the ends of two windows.
    pub stride: usize,
    /// Passes over all windows.
    pub epochs: usize,
    /// Windows a step.
    pub batch: usize,
    /// Learning rate, the same throughout.
    pub learning_rate: f64,
    /// Decoupled weight decay, on every parameter.
    pub weight_decay: f32,
    /// Samples from one of the LSTM's steps to the next. The reference's 1 makes 500 steps a window, ten
    /// times the work of 10.
    pub lstm_step: usize,
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

/// Why there are no settings.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The preset itself.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// Not TOML, or a table that baselines cannot be trained with.
    #[error("preset {name}: [baselines]: {reason}")]
    Baselines {
        /// Which preset.
        name: String,
        /// What is wrong.
        reason: String,
    },
}

/// A preset and the settings of its baselines: `study`, a preset of the product, or a TOML file, whose
/// table `[baselines]` is the reference's settings where it is left out.
///
/// # Errors
/// When there is no such preset, a key is unknown or a number cannot be run with.
pub fn find_preset(name: &str) -> Result<(Preset, BaselineSettings), SettingsError> {
    let text = if name == STUDY.0 {
        STUDY.1.to_owned()
    } else if Path::new(name).is_file() {
        std::fs::read_to_string(name).map_err(|error| refuse(name, error.to_string()))?
    } else {
        return Ok((Preset::find(name)?, BaselineSettings::default()));
    };
    let mut tables: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| refuse(name, error.to_string()))?;
    let settings = match tables.remove(TABLE) {
        None => BaselineSettings::default(),
        Some(table) => table
            .try_into()
            .map_err(|error: toml::de::Error| refuse(name, error.to_string()))?,
    };
    settings.check(name)?;
    Ok((Preset::parse(name, &tables.to_string())?, settings))
}

fn refuse(name: &str, reason: String) -> SettingsError {
    SettingsError::Baselines {
        name: name.to_owned(),
        reason,
    }
}

impl BaselineSettings {
    fn check(&self, name: &str) -> Result<(), SettingsError> {
        if self.stride == 0 || self.batch == 0 || self.epochs == 0 {
            let reason = "expected stride, batch and epochs of 1 or more, found 0";
            return Err(refuse(name, reason.to_owned()));
        }
        if !(1..=500).contains(&self.lstm_step) {
            let reason = format!("expected lstm_step of 1 to 500, found {}", self.lstm_step);
            return Err(refuse(name, reason));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_study_has_settings_of_its_own_and_the_paper_has_the_references() {
        let (study, settings) = find_preset("study").unwrap();
        assert_eq!((study.name.as_str(), settings.epochs), ("study", 6));
        assert_eq!(find_preset("paper").unwrap().1, BaselineSettings::default());
    }

    #[test]
    fn a_table_that_cannot_be_trained_with_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |table: &str| {
            let path = folder.path().join("mine.toml");
            let study = STUDY.1.split("[baselines]").next().unwrap();
            std::fs::write(&path, format!("{study}\n[baselines]\n{table}\n")).unwrap();
            find_preset(path.to_str().unwrap()).unwrap_err().to_string()
        };
        assert!(refused("lstm_step = 0").contains("1 to 500"));
        assert!(refused("stride = 0").contains("stride"));
        assert!(refused("nonsense = 1").contains("nonsense"));
    }
}
