//! Targets that the build script of the firmware accepts.

use std::path::Path;
use std::process::{Command, Output};

#[expect(dead_code, reason = "the build script's own entry point")]
#[path = "../firmware/build.rs"]
mod build;

#[test]
fn only_the_hard_float_target_with_dsp_instructions_is_a_boards() {
    assert!(build::has_fpu_and_dsp("thumbv7em-none-eabihf"));
    for target in [
        "thumbv7em-none-eabi",
        "thumbv7m-none-eabi",
        "thumbv8m.main-none-eabihf",
    ] {
        assert!(!build::has_fpu_and_dsp(target), "{target}");
    }
}

/// A debugger sets the log to wait for it, and may be unplugged: then the next line that finds the log full would wait for
/// ever, with interrupts disabled. The feature makes the log drop what it has no room for.
#[test]
fn the_debuggers_log_never_waits_for_a_reader() -> anyhow::Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml");
    let manifest: toml::Table = std::fs::read_to_string(path)?.parse()?;
    let log = manifest["target"]["cfg(target_os = \"none\")"]["dependencies"]["defmt-rtt"].clone();
    let features = log.get("features").and_then(toml::Value::as_array);
    let never_waits = features.is_some_and(|all| {
        all.iter()
            .any(|feature| feature.as_str() == Some("disable-blocking-mode"))
    });
    assert!(never_waits, "{log}");
    Ok(())
}

/// Compiles the build script as cargo does and runs it for a target, in a folder with the firmware's place in the workspace.
fn run_for(target: &str) -> Output {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware");
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("build");
    let compiled = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
        .args(["--edition", "2024", "-o"])
        .arg(&script)
        .arg("build.rs")
        .current_dir(&firmware)
        .status()
        .expect("rustc, which compiled this test");
    assert!(compiled.success());
    Command::new(&script)
        .current_dir(&firmware)
        .env("CARGO_CFG_TARGET_OS", "none")
        .env("TARGET", target)
        .env("OUT_DIR", folder.path())
        .env("CARGO_FEATURE_NRF52840", "1")
        .output()
        .unwrap()
}

#[test]
fn a_build_for_a_target_without_fpu_fails_and_names_the_target_to_build_for() {
    for target in ["thumbv7em-none-eabi", "thumbv7m-none-eabi"] {
        let output = run_for(target);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{target}");
        let named = error.contains(target) && error.contains("build for thumbv7em-none-eabihf");
        assert!(named, "{target}: {error}");
    }
    let output = run_for("thumbv7em-none-eabihf");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
}
