//! The browser of the tests of `myointent live`.

use std::{env, path::PathBuf, process::Command};

use anyhow::{Result, bail, ensure};

use crate::debian;

/// Names another browser of Chromium's kind than the one on the path.
pub const VARIABLE: &str = "MYOINTENT_CHROMIUM";

/// The command that installs what is missing.
const HINT: &str = "cargo xtask browser --install";

/// Its program and the Debian package of it, and the letters of the page.
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
    let program: PathBuf = env::var_os(VARIABLE).map_or_else(|| CHROMIUM.into(), Into::into);
    match Command::new(&program).arg("--version").output() {
        Ok(output) if output.status.success() => Ok(program),
        _ => bail!("no browser {}: {HINT}", program.display()),
    }
}
