//! `myointent completions` and `myointent man`: shell completions and manual pages.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use super::Cli;

/// Arguments of `completions`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent completions bash > ~/.local/share/bash-completion/completions/myointent\n  \
    myointent completions zsh  > ~/.zfunc/_myointent        # with ~/.zfunc in fpath\n  \
    myointent completions fish > ~/.config/fish/completions/myointent.fish"
)]
pub struct Arguments {
    /// The shell.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  myointent man --out ~/.local/share/man/man1; man myointent-train"
)]
pub struct ManArguments {
    /// Folder to write them to, a page for each command.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Prints the completion script of the shell.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut script = Vec::new();
    let mut command = Cli::command();
    let name = command.get_name().to_owned();
    clap_complete::generate(arguments.shell, &mut command, name, &mut script);
    std::io::stdout().write_all(&script)?;
    Ok(())
}

/// Writes the manual pages.
pub(super) fn run_man(arguments: &ManArguments) -> anyhow::Result<()> {
    let out = &arguments.out;
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    clap_mangen::generate_to(Cli::command(), out).with_context(|| out.display().to_string())?;
    writeln!(std::io::stdout(), "{}", out.display())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("man1");
        run_man(&ManArguments { out: out.clone() }).unwrap();
        for command in Cli::command().get_subcommands() {
            let page = out.join(format!("myointent-{}.1", command.get_name()));
            let text = std::fs::read_to_string(&page).unwrap();
            assert!(
                text.starts_with(".ie") && text.contains(".SH SYNOPSIS"),
                "{}",
                page.display()
            );
        }
    }
}
