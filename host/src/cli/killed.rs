//! A command killed between any two changes of its run folder, and then resumed, produces the same files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use clap::Parser as _;

use super::Cli;
use execution::run_folder::kill;
use presets::BUILT_IN;
use recordings::synthetic::{self, SynthOptions};

/// Smallest possible preset: three people, two epochs of teacher and student.
fn preset(folder: &Path) -> PathBuf {
    let edits = [
        ("name = \"quickstart\"", "name = \"tiny\""),
        ("spliced_seconds = 180.0", "spliced_seconds = 10.0"),
        ("stride = 150", "stride = 600"),
        ("epochs = 5", "epochs = 2"),
        ("epochs = 6", "epochs = 2"),
        ("steps = 150", "steps = 1"),
        ("batch = 32", "batch = 2"),
        ("patches = 100", "patches = 40"),
        ("patch = 20", "patch = 100"),
        ("d_model = 64", "d_model = 16"),
        ("feed_forward = 256", "feed_forward = 16"),
    ];
    let mut text = BUILT_IN[0].1.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.join("tiny.toml");
    fs::write(&path, text).unwrap();
    path
}

/// Runs in a process of its own: random weights come from one generator a process, and other tests use it too.
#[test]
fn a_quickstart_killed_at_any_write_resumes_to_the_same_files() {
    let name = "cli::killed::at_every_write";
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--ignored", "--nocapture"])
        .output()
        .unwrap();
    let [out, log] = [child.stdout, child.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(child.status.success(), "{log}\n{out}");
    assert!(out.contains("1 passed"), "{out}");
}

#[test]
#[ignore = "the test above starts it, as a process"]
fn at_every_write() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let data = folder.join("data");
    let options = SynthOptions {
        subjects: 3,
        recordings: 1,
        seconds: 12,
        ..SynthOptions::default()
    };
    synthetic::write(&options, &data).unwrap();
    let preset = preset(folder);
    let quickstart = |run: &Path, resume: bool| {
        let [preset, data, run] = [&preset, &data, run].map(|path| path.to_str().unwrap());
        let mut line = vec!["myointent", "quickstart", "--preset", preset];
        line.extend(["--data", data, "--run", run]);
        line.extend(resume.then_some("--resume"));
        Cli::try_parse_from(line).unwrap().run() == ExitCode::SUCCESS
    };
    let result = |run: &Path| {
        let files = [
            "student.intent",
            "results.json",
            "teacher.jsonl",
            "student.jsonl",
        ];
        files.map(|name| fs::read(run.join(name)).unwrap())
    };
    let whole = folder.join("whole");
    assert!(quickstart(&whole, false));
    let expected = result(&whole);

    let mut kills = 0;
    loop {
        let run = folder.join(format!("run-{kills}"));
        let Some(done) = kill::after(kills, || quickstart(&run, false)) else {
            // A run that never wrote its configuration has nothing to resume.
            let resume = run.join("config.json").exists();
            assert!(quickstart(&run, resume), "killed at point {kills}");
            assert!(result(&run) == expected, "killed at point {kills}");
            fs::remove_dir_all(&run).unwrap();
            kills += 1;
            continue;
        };
        assert!(done);
        break;
    }
    // Three points a file: half written, not yet renamed, renamed.
    assert_eq!(kills, 3 * 19);
}
