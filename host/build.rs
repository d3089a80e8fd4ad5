//! Fixes the revision of the source that is compiled, for `execution::revision`.

use std::path::Path;
use std::process::Command;

/// Files that are compiled into the programs, relative to the repository's root.
const SOURCES: [&str; 4] = ["host", "shared", "Cargo.toml", "Cargo.lock"];

fn main() {
    let revision = revision().unwrap_or_default();
    println!("cargo::rustc-env=MYOINTENT_REVISION={revision}");
}

/// The commit, with `-dirty` if sources differ from it; none outside the repository of this file, of a crate unpacked
/// below somebody else's repository for instance.
fn revision() -> Option<String> {
    println!("cargo::rerun-if-changed=build.rs");
    // A commit, checkout or reset adds a line to the log of HEAD. Not watched is the index: every `git status` may
    // write it, and what `git add` changes is part of no commit yet.
    for name in ["HEAD", "logs/HEAD"] {
        // Relative to the working directory, which cargo sets to this package.
        if let Some(path) = git(&["rev-parse", "--git-path", name])
            && Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    git(&["ls-files", "--error-unmatch", "Cargo.toml"])?;
    let root = git(&["rev-parse", "--show-toplevel"])?;
    for source in SOURCES {
        println!("cargo::rerun-if-changed={root}/{source}");
    }
    let commit = git(&["describe", "--always", "--abbrev=12"])?;
    let status = [
        "--no-optional-locks",
        "-C",
        &root,
        "status",
        "--porcelain",
        "--",
    ];
    let changes = git(&[&status[..], &SOURCES].concat())?;
    let dirty = if changes.is_empty() { "" } else { "-dirty" };
    Some(format!("{commit}{dirty}"))
}

/// Output of git in this package's folder; none if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let folder = std::env::var_os("CARGO_MANIFEST_DIR")?;
    let output = Command::new("git")
        .args(arguments)
        .current_dir(folder)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
