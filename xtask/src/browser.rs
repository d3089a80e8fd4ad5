//! The browser of the tests of `myointent live`.

use std::{env, path::PathBuf, process::Command};

use anyhow::{Result, bail, ensure};

use crate::debian;

/// Names another browser of Chromium's kind than the one on the path.
pub const VARIABLE: &str = "MYOINTENT_CHROMIUM";

/// The command that installs what is missing.
const HINT: &str = "cargo xtask browser --install";

/// Programs that are tried.
const PROGRAMS: [&str; 3] = ["chromium", "google-chrome", "chromium-browser"];
/// Debian's packages: the browser, and the letters of the page.
const CHROMIUM: &str = "chromium";
const FONT: &str = "fonts-dejavu-core";

/// Checks that there is a browser; with `install` it installs Debian's.
///
/// # Errors
/// When there is none, and none may be, or can be, installed.
pub fn prepare(install: bool) -> Result<()> {
    if let Err(error) = find() {
        ensure!(install, error);
        println!("{}", debian::install_command(&[CHROMIUM, FONT]));
        debian::install(&[CHROMIUM, FONT])?;
    }
    println!("browser {}", find()?.display());
    Ok(())
}

/// A browser that runs.
///
/// # Errors
/// When there is none; names the command that installs one.
pub fn find() -> Result<PathBuf> {
    let runs = |program: &PathBuf| {
        let version = Command::new(program).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    };
    if let Some(program) = env::var_os(VARIABLE).map(PathBuf::from) {
        ensure!(
            runs(&program),
            "{VARIABLE}: {} does not run",
            program.display()
        );
        return Ok(program);
    }
    match PROGRAMS.map(PathBuf::from).into_iter().find(runs) {
        Some(program) => Ok(program),
        None => bail!("no browser, {}: {HINT}", PROGRAMS.join(" nor ")),
    }
}
