//! Small run through the command line itself: the smallest that trains.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser as _;
use myointent::cli::Cli;
use recordings::synthetic::{self, SynthOptions};

/// Writes a preset that trains in seconds; its accuracy does not matter.
pub fn small_preset(folder: &Path) -> PathBuf {
    let text = presets::BUILT_IN[0].1;
    let text = text
        .replace("name = \"quickstart\"", "name = \"small\"")
        .replace("spliced_seconds = 180.0", "spliced_seconds = 20.0")
        .replace("stride = 150", "stride = 600")
        .replace("epochs = 5", "epochs = 1")
        .replace("epochs = 6", "epochs = 1")
        .replace("steps = 150", "steps = 4")
        .replace("batch = 32", "batch = 8")
        .replace("d_model = 64", "d_model = 48")
        .replace("feed_forward = 256", "feed_forward = 64");
    let path = folder.join("small.toml");
    fs::write(&path, text).unwrap();
    path
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

/// Makes an empty folder of this test's own.
pub fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes synthetic recordings of four subjects and returns their folder and one file.
pub fn recordings(folder: &Path) -> (PathBuf, PathBuf) {
    let data = folder.join("data");
    let options = SynthOptions {
        subjects: 4,
        recordings: 1,
        seconds: 30,
        ..SynthOptions::default()
    };
    let files = synthetic::write(&options, &data).unwrap();
    (data, files[0].clone())
}
