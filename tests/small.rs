//! Small runs through the command line itself, in this process or in one of its own: the smallest that train.

#![allow(dead_code, reason = "each test program uses a part")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use clap::Parser as _;
use myointent::cli::Cli;
use recordings::synthetic::{self, SynthOptions};

/// Writes `small.toml`, a preset that trains in seconds; its accuracy does not matter.
pub fn small_preset(folder: &Path) -> PathBuf {
    let text = shrunk(presets::BUILT_IN[0].1);
    let path = folder.join("small.toml");
    fs::write(
        &path,
        text.replace("name = \"quickstart\"", "name = \"small\""),
    )
    .unwrap();
    path
}

/// Makes the text of a preset small.
pub fn shrunk(text: &str) -> String {
    text.replace("spliced_seconds = 180.0", "spliced_seconds = 20.0")
        .replace("stride = 150", "stride = 600")
        .replace("epochs = 5", "epochs = 1")
        .replace("epochs = 6", "epochs = 1")
        .replace("steps = 150", "steps = 4")
        .replace("batch = 32", "batch = 8")
        .replace("d_model = 64", "d_model = 48")
        .replace("feed_forward = 256", "feed_forward = 64")
}

/// Runs the program with the words of a line.
pub fn run(line: &str) -> ExitCode {
    let words = std::iter::once("myointent").chain(line.split_whitespace());
    Cli::try_parse_from(words).unwrap().run()
}

/// Runs the program with the words of a line; returns true if it succeeds.
pub fn myointent(line: &str) -> bool {
    run(line) == ExitCode::SUCCESS
}

/// Runs the program with the words of a line of [`paths`]; returns true if it succeeds.
pub fn in_folder(folder: &Path, line: &str) -> bool {
    myointent(&paths(folder, line))
}

/// A line with each `@name` as a path in a folder.
pub fn paths(folder: &Path, line: &str) -> String {
    line.replace('@', &format!("{}/", folder.display()))
}

const LINE: &str = "MYOINTENT_TEST_LINE";
/// Line before the output of a process, after the lines that the test program writes by itself.
pub const BEGIN: &str = "-- begin --";

/// Builds the command of the program, with the words of a line, in a process of its own: this test program, which starts with
/// [`child`].
pub fn process(line: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", "small::child", "--ignored", "--nocapture"])
        .env(LINE, line)
        .env_remove("MYOINTENT_DATA");
    command
}

/// Runs the command line of the process that [`process`] starts. It is not a test.
#[test]
#[ignore = "other tests start it, as a process"]
fn child() {
    let Ok(line) = std::env::var(LINE) else {
        return;
    };
    println!("{BEGIN}");
    let words = std::iter::once("myointent").chain(line.split_whitespace());
    let code = match Cli::try_parse_from(words) {
        Ok(cli) => cli.run(),
        Err(error) => error.exit(),
    };
    let mut known = [0, 1, 2, 130].into_iter();
    let code = known.find(|&known| code == ExitCode::from(known));
    // It exits here: the test program would write further lines.
    std::process::exit(code.map_or(99, i32::from));
}

/// Makes an empty folder of this test's own.
pub fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes synthetic recordings of four subjects into `data` and returns it.
pub fn recordings(folder: &Path) -> PathBuf {
    let data = folder.join("data");
    let options = SynthOptions {
        subjects: 4,
        recordings: 1,
        seconds: 30,
        ..SynthOptions::default()
    };
    synthetic::write(&options, &data).unwrap();
    data
}
