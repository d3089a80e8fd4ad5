//! Tools that tests need besides a compiler: QEMU, which runs those of `shared`, and a Python environment with Bumble, the
//! virtual Bluetooth controller that the virtual armband is built on.

use std::{
    env, fs,
    path::PathBuf,
    process::{Command, Stdio},
};

use anyhow::{Result, bail, ensure};

use crate::debian;
use crate::run;

const HINT: &str = "cargo xtask emulator --install";

/// QEMU's program, and the Debian package of it.
pub const QEMU: &str = "qemu-system-arm";

/// Names another Python that has the requirements, instead of the environment that
/// `cargo xtask emulator --install` creates.
pub const PYTHON_VARIABLE: &str = "MYOINTENT_PYTHON";

/// Checks that emulator and armband can run; with `install` it installs what is missing.
pub fn prepare(install: bool) -> Result<()> {
    if qemu().is_err() {
        debian::provide(&[QEMU], install, "no emulator:")?;
    }
    println!("{}", qemu()?);
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

/// Version line of QEMU, which emulates the Cortex-M4F of tests and instruction counts.
pub fn qemu() -> Result<String> {
    match Command::new(QEMU).arg("--version").output() {
        Ok(output) if output.status.success() => {
            let text = String::from_utf8_lossy(&output.stdout);
            Ok(text.lines().next().unwrap_or(QEMU).to_owned())
        }
        _ => bail!("no {QEMU}: {HINT}"),
    }
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
    let mut python = Command::new("python3");
    let has_venv = python.args(["-c", "import ensurepip, venv"]).output();
    if !has_venv.is_ok_and(|output| output.status.success()) {
        debian::provide(&["python3", "python3-venv"], true, "")?;
    }
    println!("creating {}", environment.display());
    let mut create = Command::new("python3");
    create.args(["-m", "venv"]).arg(&environment);
    run(
        &mut create,
        &format!("python3 -m venv {} failed", environment.display()),
    )?;
    let mut pip = Command::new(environment.join("bin/python"));
    pip.args(["-m", "pip", "install", "--disable-pip-version-check"]);
    pip.args(["--quiet", "-r"]);
    pip.arg(armband().join("requirements.txt"));
    run(&mut pip, "pip could not install the requirements")
}

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
