//! Tools that tests need besides a compiler: QEMU, which runs those of `shared`, and a Python environment with Bumble, the
//! virtual Bluetooth controller that the virtual armband is built on.

use std::{
    env, fs,
    path::PathBuf,
    process::{Command, Stdio},
};

use anyhow::{Context as _, Result, bail, ensure};

use crate::debian;
use crate::qemu::{self, HINT, QEMU};

/// Names another Python that has the requirements, instead of the environment that
/// `cargo xtask emulator --install` creates.
pub const PYTHON_VARIABLE: &str = "MYOINTENT_PYTHON";

/// Checks that emulator and armband can run; with `install` it installs what is missing.
pub fn prepare(install: bool) -> Result<()> {
    if qemu::find().is_err() {
        debian::provide(&[QEMU], install, "no emulator:")?;
    }
    println!("{}", qemu::find()?);
    if python().is_err() {
        ensure!(
            install,
            "no Python with the armband's requirements.\n  {HINT}\ncreates one in {}",
            environment().display()
        );
        create_environment()?;
    }
    println!(
        "Python {} has {}",
        python()?.display(),
        requirements().join(", ")
    );
    Ok(())
}

/// A Python that can run the virtual armband.
pub fn python() -> Result<PathBuf> {
    let python =
        env::var_os(PYTHON_VARIABLE).map_or_else(|| environment().join("bin/python"), Into::into);
    let checked = Command::new(&python)
        .args(["-c", &check()])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match checked {
        Ok(status) if status.success() => Ok(python),
        Ok(_) => bail!(
            "{} lacks {}: {HINT}",
            python.display(),
            requirements().join(", ")
        ),
        Err(_) => bail!("no Python at {}: {HINT}", python.display()),
    }
}

/// The folder of the virtual armband's program.
pub fn armband() -> PathBuf {
    crate::workspace().join("tests/armband")
}

/// A Python program that fails unless every requirement is installed in the required version.
fn check() -> String {
    let versions: Vec<_> = requirements()
        .iter()
        .filter_map(|line| line.split_once("=="))
        .map(|(package, version)| format!("assert version('{package}') == '{version}'"))
        .collect();
    format!(
        "from importlib.metadata import version\n{}",
        versions.join("\n")
    )
}

fn requirements() -> Vec<String> {
    let text = fs::read_to_string(armband().join("requirements.txt")).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

fn create_environment() -> Result<()> {
    let environment = environment();
    // On Debian the module that creates environments is a package of its own.
    if !runs(Command::new("python3").args(["-c", "import ensurepip, venv"])) {
        debian::provide(&["python3", "python3-venv"], true, "")?;
    }
    println!("creating {}", environment.display());
    ensure!(
        runs(
            Command::new("python3")
                .args(["-m", "venv"])
                .arg(&environment)
        ),
        "python3 -m venv {} failed",
        environment.display()
    );
    let status = Command::new(environment.join("bin/python"))
        .args([
            "-m",
            "pip",
            "install",
            "--disable-pip-version-check",
            "--quiet",
            "-r",
        ])
        .arg(armband().join("requirements.txt"))
        .status()
        .context("pip cannot be run")?;
    ensure!(status.success(), "pip could not install the requirements");
    Ok(())
}

fn runs(command: &mut Command) -> bool {
    let quiet = command.stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

/// The folder of the environment.
fn environment() -> PathBuf {
    crate::target().join("armband")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_asks_for_every_requirement_by_its_version() {
        let check = check();
        assert_eq!(requirements().len(), check.matches("assert").count());
        assert!(check.contains("assert version('bumble') == '"), "{check}");
    }
}
