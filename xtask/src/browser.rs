//! The browsers of the tests of `myointent live`.

use std::{env, path::PathBuf, process::Command};

use anyhow::{Result, bail, ensure};

use crate::debian;

const HINT: &str = "cargo xtask browser --install";

/// Debian's package of the letters of the page.
const FONT: &str = "fonts-dejavu-core";

/// Kind of browser.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BrowserKind {
    /// Chromium, and what is made of it.
    Chromium,
    /// Firefox.
    Firefox,
}

impl BrowserKind {
    /// Environment variable that names another program than those on the path; programs that are tried; Debian's package.
    const fn names(self) -> (&'static str, &'static [&'static str], &'static str) {
        match self {
            Self::Chromium => (
                "MYOINTENT_CHROMIUM",
                &["chromium", "google-chrome", "chromium-browser"],
                "chromium",
            ),
            Self::Firefox => (
                "MYOINTENT_FIREFOX",
                &["firefox-esr", "firefox"],
                "firefox-esr",
            ),
        }
    }

    /// A browser of this kind that runs.
    pub fn find(self) -> Result<PathBuf> {
        let runs = |program: &PathBuf| {
            let version = Command::new(program).arg("--version").output();
            version.is_ok_and(|output| output.status.success())
        };
        let (variable, programs, _) = self.names();
        if let Some(program) = env::var_os(variable).map(PathBuf::from) {
            ensure!(
                runs(&program),
                "{variable}: {} does not run",
                program.display()
            );
            return Ok(program);
        }
        match programs.iter().map(PathBuf::from).find(runs) {
            Some(program) => Ok(program),
            None => bail!("no browser, {}: {HINT}", programs.join(" nor ")),
        }
    }
}

/// Checks that there is a browser of each kind; with `install` it installs Debian's.
pub fn prepare(install: bool) -> Result<()> {
    for kind in [BrowserKind::Chromium, BrowserKind::Firefox] {
        if let Err(error) = kind.find() {
            debian::provide(&[kind.names().2, FONT], install, &error.to_string())?;
        }
    }
    for kind in [BrowserKind::Chromium, BrowserKind::Firefox] {
        println!("browser {}", kind.find()?.display());
    }
    Ok(())
}
