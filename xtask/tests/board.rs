//! `cargo board` on a machine that lacks what it needs.
#![cfg(unix)]

use std::env;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

/// Folder for a `PATH` that has cargo and none of the project's tools; `rustup` lists the targets of `echo`.
fn bare_path(folder: &Path, targets: &str) {
    symlink(env!("CARGO"), folder.join("cargo")).unwrap();
    let script = format!("#!/bin/sh\necho {targets}\n");
    let rustup = folder.join("rustup");
    std::fs::write(&rustup, script).unwrap();
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(&rustup, mode).unwrap();
}

/// Runs the alias `cargo board` as `.cargo/config.toml` has it, with the compiled program in place of `run --package xtask`.
fn board(targets: &str) -> String {
    let folder = env::temp_dir().join(format!("board-{}-{targets}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    bare_path(&folder, targets);
    let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .arg("board")
        .env("PATH", &folder)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(!output.status.success());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn what_is_missing_is_said_before_anything_is_compiled() {
    let config = include_str!("../../.cargo/config.toml");
    assert!(config.contains("board = \"run --quiet --package xtask -- board\""));
    for (targets, missing) in [
        (
            "x86_64-unknown-linux-gnu",
            "rustup target add thumbv7em-none-eabihf",
        ),
        ("thumbv7em-none-eabihf", "probe-rs"),
    ] {
        let text = board(targets);
        assert!(text.contains(missing), "{text}");
        assert!(!text.contains("Compiling"), "{text}");
    }
}
