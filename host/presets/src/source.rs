//! Sources of presets: the program itself, or TOML files. Unknown keys are refused.

use std::path::Path;

use thiserror::Error;

use super::Preset;
use super::check::Invalid;
use execution::bounded_read;

/// Presets that come with the program: name and text.
pub const BUILT_IN: [(&str, &str); 3] = [
    ("quickstart", include_str!("../quickstart.toml")),
    ("cpu", include_str!("../cpu.toml")),
    ("paper", include_str!("../paper.toml")),
];

/// Error of finding or reading a preset.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum PresetError {
    #[error("preset {name}: no built-in preset of that name (there are {known}) and no such file")]
    Missing {
        name: String,
        known: String,
        source: std::io::Error,
    },
    #[error("preset {name}: {reason}")]
    Syntax { name: String, reason: String },
    #[error("preset {name}: {value}")]
    Value { name: String, value: Invalid },
}

impl Preset {
    /// A built-in preset by name, or else a TOML file.
    ///
    /// # Errors
    /// When there is neither, or the preset is invalid.
    pub fn find(name: &str) -> Result<Self, PresetError> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(name, text);
        }
        let text =
            bounded_read::read_text(Path::new(name), bounded_read::PRESET).map_err(|source| {
                PresetError::Missing {
                    name: name.to_owned(),
                    known: BUILT_IN.map(|(known, _)| known).join(", "),
                    source,
                }
            })?;
        Self::parse(name, &text)
    }

    /// Parses a preset's text; `name` is for error messages.
    ///
    /// # Errors
    /// When a key is unknown or missing, or a value is invalid.
    pub fn parse(name: &str, text: &str) -> Result<Self, PresetError> {
        let syntax = |error: toml::de::Error| PresetError::Syntax {
            name: name.to_owned(),
            reason: error.to_string(),
        };
        let preset: Self = toml::from_str(text).map_err(syntax)?;
        // TOML's integers have a sign. The line above also takes larger ones that fit without a sign, which other
        // readers refuse.
        toml::from_str::<toml::Table>(text).map_err(syntax)?;
        match preset.invalid() {
            None => Ok(preset),
            Some(value) => Err(PresetError::Value {
                name: name.to_owned(),
                value,
            }),
        }
    }

    /// The preset as TOML, for the run folder.
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_preset_is_valid_and_survives_being_written() {
        for (name, text) in BUILT_IN {
            let preset = Preset::parse(name, text).unwrap();
            assert_eq!(preset.name, name);
            assert_eq!(Preset::parse(name, &preset.to_toml()).unwrap(), preset);
        }
    }

    #[test]
    fn a_number_that_toml_does_not_have_is_refused() {
        let text = BUILT_IN[0]
            .1
            .replace("seed = 42", "seed = 17293822569100607487");
        let error = Preset::parse("mine", &text).unwrap_err().to_string();
        assert!(error.contains("too large"), "{error}");
    }

    #[test]
    fn an_unknown_key_is_refused_with_its_name() {
        let text = format!("nonsense = 1\n{}", BUILT_IN[0].1);
        let error = Preset::parse("mine", &text).unwrap_err().to_string();
        assert!(error.contains("nonsense"), "{error}");
    }
}
