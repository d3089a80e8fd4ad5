//! The GPU backend, where Vulkan finds an adapter; a software one, such as Mesa's lavapipe, will do.
//!
//! `cargo test --locked -p myointent-tests --features wgpu --test wgpu` (docs/decisions.md, "Which GPU backend?").

#[path = "small.rs"]
mod small;
#[path = "wgpu/training.rs"]
mod training;

use std::fs;
use std::process::Output;

use shared::model::file::Model;
use small::{folder, in_folder, process, recordings, small_preset};

/// The program where neither Vulkan nor OpenGL finds a driver.
fn without_adapter(line: &str) -> Output {
    let nowhere = "/nonexistent/driver.json";
    process(line)
        .env("VK_DRIVER_FILES", nowhere)
        .env("VK_ICD_FILENAMES", nowhere)
        .env("__EGL_VENDOR_LIBRARY_FILENAMES", nowhere)
        .output()
        .unwrap()
}

#[test]
fn without_an_adapter_the_message_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let run = run.display();
    let line = format!("train --preset quickstart --run {run} --backend wgpu");
    let output = without_adapter(&line);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    for part in ["error: no adapter", "vulkaninfo", "--backend flex"] {
        assert!(message.contains(part), "{part}: {message}");
    }
}

#[test]
fn a_run_goes_through_all_steps_and_repeats() {
    if training::gpu().is_none() {
        return;
    }
    let folder = folder("wgpu-run");
    recordings(&folder);
    small_preset(&folder);
    let file = |run: &str| folder.join(run).join("student.intent");
    let on_gpu = |command: &str, run: &str| {
        let line = format!("{command} --run @{run} --backend wgpu");
        assert!(in_folder(&folder, &line), "{line}");
    };
    for run in ["first", "again"] {
        on_gpu("train --preset @small.toml --data @data", run);
        on_gpu("quantize", run);
    }
    let bytes = fs::read(file("first")).unwrap();
    assert!(Model::parse(&bytes).is_ok());
    assert_eq!(bytes, fs::read(file("again")).unwrap());
    on_gpu("evaluate", "first");
    assert!(folder.join("first/report.html").is_file());
    // Its weights are those of any backend.
    assert!(in_folder(&folder, "export --run @first --backend flex"));
}
