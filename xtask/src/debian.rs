//! Debian's packages: which are missing, and their installation.

use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use crate::run;

/// Packages that are not installed.
fn missing<'p>(packages: &[&'p str]) -> Vec<&'p str> {
    let installed = |package: &&&str| {
        let status = Command::new("dpkg-query")
            .args(["-W", "-f", "${db:Status-Status}", package])
            .output();
        status.is_ok_and(|output| output.stdout == b"installed")
    };
    packages
        .iter()
        .filter(|package| !installed(package))
        .copied()
        .collect()
}

/// Installs the packages that are missing, as root; without `install` it fails with `otherwise` and the command.
pub fn provide(packages: &[&str], install: bool, otherwise: &str) -> Result<()> {
    let packages = &missing(packages)[..];
    if packages.is_empty() {
        return Ok(());
    }
    let command = format!(
        "apt-get install -y --no-install-recommends {}",
        packages.join(" ")
    );
    ensure!(install, "{otherwise}\n  {command}\n(--install runs this)");
    println!("{command}");
    let apt = |arguments: &[&str]| {
        let mut apt = Command::new("apt-get");
        apt.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        run(&mut apt, &format!("apt-get {} failed", arguments.join(" ")))
            .context("install the packages by hand")
    };
    apt(&["update", "-q"])?;
    apt(&[
        &["install", "-y", "-q", "--no-install-recommends"],
        packages,
    ]
    .concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_that_does_not_exist_is_missing() {
        assert_eq!(
            missing(&["no-such-package-at-all"]),
            ["no-such-package-at-all"]
        );
    }
}
