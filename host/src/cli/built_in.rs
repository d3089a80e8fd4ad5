//! `myointent presets` and `myointent protocols`: what is built in, as a list or as text.

use std::io::Write as _;
use std::path::Path;

use clap::Args;

use execution::bounded_read;
use presets::Preset;
use web::record::protocol::{self, Protocol};

#[derive(Debug, Args)]
pub struct PresetArguments {
    /// Preset to print as TOML; all are listed if not given.
    name: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent protocols\n  myointent protocols quick > mine.toml\n  myointent record --person anna --demo --protocol mine.toml"
)]
pub struct ProtocolArguments {
    /// Protocol to print as TOML; all are listed if not given. A file is checked.
    name: Option<String>,
}

/// Lists the built-in presets or prints one.
pub(super) fn presets(arguments: &PresetArguments) -> anyhow::Result<()> {
    let built_in = &presets::BUILT_IN;
    print(built_in, arguments.name.as_deref(), |name| {
        // The source text with its comments, after a check that it is valid.
        Preset::find(name)?;
        if let Some((_, text)) = built_in.iter().find(|(known, _)| *known == name) {
            return Ok((*text).to_owned());
        }
        Ok(bounded_read::read_text(
            Path::new(name),
            bounded_read::PRESET,
        )?)
    })
}

/// Lists the built-in protocols or prints one.
pub(super) fn protocols(arguments: &ProtocolArguments) -> anyhow::Result<()> {
    print(&protocol::BUILT_IN, arguments.name.as_deref(), |name| {
        Protocol::find(name)?;
        Ok(protocol::text(name)?)
    })
}

/// Prints the text of a name; without one, lists what is built in by the remarks at the start of each text.
fn print(
    built_in: &[(&str, &str)],
    name: Option<&str>,
    text: impl Fn(&str) -> anyhow::Result<String>,
) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if let Some(name) = name {
        write!(out, "{}", text(name)?)?;
        return Ok(());
    }
    for (name, text) in built_in {
        let about = text.lines().map_while(|line| line.strip_prefix("# "));
        writeln!(out, "{name:12} {}", about.collect::<Vec<_>>().join(" "))?;
    }
    Ok(())
}
