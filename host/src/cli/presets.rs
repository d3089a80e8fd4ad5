//! `myointent presets`: what can be run by name.

use std::io::Write as _;

use clap::Args;

use crate::run::preset::{BUILT_IN, Preset};

/// Arguments of `presets`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Preset to print as TOML; lists all if not given.
    name: Option<String>,
}

/// Lists the built-in presets or prints one.
///
/// # Errors
/// When there is no such preset.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if let Some(name) = &arguments.name {
        // As it was written, comments included, once it is known to be good.
        Preset::find(name)?;
        let text = BUILT_IN
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, text)| (*text).to_owned());
        write!(
            out,
            "{}",
            text.map_or_else(|| std::fs::read_to_string(name), Ok)?
        )?;
        return Ok(());
    }
    for (name, text) in BUILT_IN {
        let about: Vec<&str> = text
            .lines()
            .map_while(|line| line.strip_prefix("# "))
            .collect();
        writeln!(out, "{name:12} {}", about.join(" "))?;
    }
    Ok(())
}
