//! The GPU backend, where Vulkan finds an adapter; a software one, such as Mesa's lavapipe, will do.
//!
//! `cargo test --locked -p myointent-tests --features wgpu --test wgpu` (docs/decisions.md, "Which GPU backend?").

#[path = "small.rs"]
mod small;
#[path = "wgpu/training.rs"]
mod training;

use std::fs;
use std::process::{Command, ExitCode, Output};

use clap::Parser as _;
use myointent::cli::Cli;
use shared::model::file::Model;
use small::{folder, myointent, recordings, small_preset};

const LINE: &str = "MYOINTENT_TEST_LINE";

/// The program in a process of its own: this test program, which starts with `child`.
fn process(line: &[&str]) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", "child", "--ignored", "--nocapture"])
        .env(LINE, serde_json::to_string(line).unwrap())
        .env_remove("MYOINTENT_DATA");
    command
}

/// Not a test: the process that [`process`] starts.
#[test]
#[ignore = "other tests start it, as a process"]
fn child() {
    let Ok(line) = std::env::var(LINE) else {
        return;
    };
    let line: Vec<String> = serde_json::from_str(&line).unwrap();
    let arguments = std::iter::once("myointent".to_owned()).chain(line);
    let code = Cli::try_parse_from(arguments).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}

/// The program where neither Vulkan nor OpenGL finds a driver.
fn without_adapter(line: &[&str]) -> Output {
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
    let output = without_adapter(&[
        "train",
        "--preset",
        "quickstart",
        "--run",
        run.to_str().unwrap(),
        "--backend",
        "wgpu",
    ]);
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
    let (data, _) = recordings(&folder);
    let preset = small_preset(&folder);
    let file = |run: &str| folder.join(run).join("student.intent");
    let on_gpu = |command: &str, run: &str| {
        let run = folder.join(run);
        let line = format!("{command} --run {} --backend wgpu", run.display());
        assert!(myointent(&line), "{line}");
    };
    for run in ["first", "again"] {
        let [preset, data] = [&preset, &data].map(|path| path.display());
        on_gpu(&format!("train --preset {preset} --data {data}"), run);
        on_gpu("quantize", run);
    }
    let bytes = fs::read(file("first")).unwrap();
    assert!(Model::parse(&bytes).is_ok());
    assert_eq!(bytes, fs::read(file("again")).unwrap());
    on_gpu("evaluate", "first");
    assert!(folder.join("first/report.html").is_file());
    // Its weights are those of any backend.
    let run = folder.join("first");
    let line = format!("export --run {} --backend flex", run.display());
    assert!(myointent(&line));
}
