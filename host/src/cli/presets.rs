//! `myointent presets`: the built-in presets.

use std::io::Write as _;
use std::path::Path;

use clap::Args;

use execution::bounded_read;
use presets::{BUILT_IN, Preset};

/// Arguments of `presets`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Preset to print as TOML; all are listed if not given.
    name: Option<String>,
}

/// Lists the built-in presets or prints one.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if let Some(name) = &arguments.name {
        // Prints the source text with its comments, after a check that it is valid.
        Preset::find(name)?;
        match BUILT_IN.iter().find(|(known, _)| known == name) {
            Some((_, text)) => write!(out, "{text}")?,
            None => {
                let text = bounded_read::read_text(Path::new(name), bounded_read::PRESET)?;
                write!(out, "{text}")?;
            }
        }
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
