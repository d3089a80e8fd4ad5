//! Two processes in one run, and runs that are killed or interrupted.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use burn::tensor::Device;
use execution::run_folder::RunFolder;
use training::run::context::RunContext;

use super::{Bench, fails, succeeds};
use crate::small::process;

#[test]
fn a_second_process_is_refused_while_a_run_is_being_made() {
    let bench = Bench::new("lock");
    let (config, library) = bench.configuration(7);
    let folder = RunFolder::open(bench.path("run")).unwrap();
    let first = RunContext::begin(folder, config, library, Device::default().autodiff()).unwrap();
    let second = bench.begin("train", "run", "--overwrite");
    let second = process(&second).output().unwrap();
    let message = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{message}");
    let pid = std::process::id().to_string();
    assert!(
        message.contains(&pid) && message.contains("since"),
        "{message}"
    );
    drop(first);
    succeeds(&bench.begin("train", "run", "--overwrite"));
}

#[test]
fn a_killed_process_leaves_no_lock() {
    let bench = Bench::new("killed");
    let mut first = process(&bench.begin("quickstart", "run", ""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let config = bench.path("run/config.json");
    while !config.exists() && first.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    first.kill().unwrap();
    first.wait().unwrap();
    fs::write(bench.path("run/old.bpk.partial"), "a torn file").unwrap();
    succeeds(&bench.begin("quickstart", "run", "--resume"));
    let left = fs::read_dir(bench.path("run")).unwrap();
    let partial = left
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .find(|name| name.contains("partial"));
    assert_eq!(partial, None);
}

#[test]
fn an_interrupted_command_advises_what_it_has() {
    let bench = Bench::new("interrupt");
    bench.edit(&[("epochs = 1", "epochs = 1000")]);
    let line = bench.begin_with("train", "@edited.toml", "run", "");
    let mut child = process(&line)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let checkpoint = bench.path("run/teacher.checkpoint");
    while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(
        message.contains("the same command and --resume"),
        "{message}"
    );
    // The run is not complete: there is nothing to quantize.
    fails(&bench.on("quantize", "run", ""), "not trained yet");
}

#[test]
fn a_closed_standard_error_is_no_panic() {
    let bench = Bench::new("stderr");
    let mut child = process(&bench.begin("train", "run", ""))
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn the_revision_is_that_of_the_program_wherever_it_is_started() {
    let bench = Bench::new("revision");
    let elsewhere = bench.path("elsewhere");
    fs::create_dir_all(&elsewhere).unwrap();
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        command.args(["-c", "user.name=x", "-c", "user.email=x@example.org"]);
        command.args(arguments).current_dir(&elsewhere);
        command.output().is_ok_and(|output| output.status.success())
    };
    let commit = ["commit", "--quiet", "--allow-empty", "--message", "x"];
    if !git(&["init", "--quiet"]) || !git(&commit) {
        myointent_tests::skip("no git");
        return;
    }
    let revision = |run: &str, at: &Path| {
        let line = bench.begin("train", run, "");
        assert!(
            process(&line)
                .current_dir(at)
                .output()
                .unwrap()
                .status
                .success()
        );
        let text = fs::read(bench.path(run).join("config.json")).unwrap();
        let config: serde_json::Value = serde_json::from_slice(&text).unwrap();
        config["git_revision"].clone()
    };
    let source = Path::new(env!("CARGO_MANIFEST_DIR"));
    let here = revision("here", source);
    assert_eq!(revision("there", &elsewhere), here);
}
