//! Which targets the build script of the firmware accepts.

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
