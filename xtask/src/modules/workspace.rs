//! The crates of a workspace, as cargo knows them.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

/// A library or a program.
pub struct Target {
    /// Its package, and which target of it where that is a program.
    pub name: String,
    /// Its root file.
    pub root: PathBuf,
}

/// Libraries and programs of all members, in the order of their names.
///
/// # Errors
/// When cargo cannot read the manifests.
pub fn targets(workspace: &Path) -> Result<Vec<Target>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version=1", "--offline"])
        .arg("--manifest-path")
        .arg(workspace.join("Cargo.toml"))
        .output()
        .context("cargo cannot be run")?;
    ensure!(
        output.status.success(),
        "cargo metadata: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata = serde_json::from_slice(&output.stdout)?;
    let mut targets = parse(&metadata).context("metadata of an unknown form")?;
    targets.sort_by(|one, other| one.name.cmp(&other.name));
    Ok(targets)
}

fn parse(metadata: &Value) -> Option<Vec<Target>> {
    let mut targets = Vec::new();
    for package in metadata["packages"].as_array()? {
        let package_name = package["name"].as_str()?;
        for target in package["targets"].as_array()? {
            let kinds = target["kind"].as_array()?;
            let root = PathBuf::from(target["src_path"].as_str()?);
            let name = match kinds.first()?.as_str()? {
                "lib" => package_name.to_owned(),
                "bin" => format!("{package_name}, program {}", target["name"].as_str()?),
                _ => continue,
            };
            targets.push(Target { name, root });
        }
    }
    Some(targets)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_and_programs_are_targets_and_tests_are_none() {
        let metadata = serde_json::json!({"packages": [{"name": "p", "targets": [
            {"name": "p", "kind": ["lib"], "src_path": "/p/src/lib.rs"},
            {"name": "tool", "kind": ["bin"], "src_path": "/p/src/main.rs"},
            {"name": "t", "kind": ["test"], "src_path": "/p/tests/t.rs"},
            {"name": "build-script-build", "kind": ["custom-build"], "src_path": "/p/build.rs"},
        ]}]});
        let targets = parse(&metadata).unwrap();
        let names: Vec<_> = targets.iter().map(|target| target.name.as_str()).collect();
        assert_eq!(names, ["p", "p, program tool"]);
        assert_eq!(targets[0].root, Path::new("/p/src/lib.rs"));
        assert!(parse(&serde_json::json!({})).is_none());
    }
}
