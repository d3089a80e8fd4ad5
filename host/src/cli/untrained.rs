//! Commands of a program built without training: they say what to build. Twin of `steps`.

/// Advice for a command that needs the training feature.
pub(crate) const WITHOUT_TRAINING: &str = "this program was built without training; `cargo run --release -- COMMAND` builds and runs all of it";

/// Commands that this program was built without.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Command {
    /// Any of them.
    #[command(
        hide = true,
        aliases = ["quickstart", "quantize", "export", "personalize"],
        disable_help_flag = true
    )]
    Train(Arguments),
}

/// Arguments of a command that this program was built without.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<std::ffi::OsString>,
}

impl Command {
    /// Says what to build.
    pub(super) fn run(&self) -> anyhow::Result<()> {
        anyhow::bail!(WITHOUT_TRAINING)
    }

    /// Whether `--resume` continues the command: there is none.
    pub(super) const fn resumes(&self) -> bool {
        false
    }
}

/// Whether `personalize` decided to keep the old model: there is no `personalize`.
pub(super) const fn keeps_the_old(_: &anyhow::Error) -> bool {
    false
}

/// Whether the user interrupted a step: there is none.
pub(super) fn is_interrupt(_: &(dyn std::error::Error + 'static)) -> bool {
    false
}
