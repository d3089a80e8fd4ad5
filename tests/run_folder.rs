//! Run folders: their files, the process that works in them, and the state that a stopped program leaves behind.

#[path = "small.rs"]
mod small;

#[path = "run_folder/belonging.rs"]
mod belonging;
#[path = "run_folder/processes.rs"]
mod processes;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

use clap::Parser as _;
use myointent::cli::Cli;
use presets::Preset;
use presets::config::ResolvedConfig;
use recordings::{LoadOptions, load};
use small::{folder, recordings, small_preset};

/// Folder with recordings and a preset.
struct Bench {
    folder: PathBuf,
    data: PathBuf,
    preset: PathBuf,
}

impl Bench {
    fn new(name: &str) -> Self {
        let folder = folder(name);
        let (data, _) = recordings(&folder);
        let preset = small_preset(&folder);
        Self {
            folder,
            data,
            preset,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes the preset with some text replaced, which must be there.
    fn edited(&self, edits: &[(&str, &str)]) -> PathBuf {
        let mut text = fs::read_to_string(&self.preset).unwrap();
        for (from, to) in edits {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        let path = self.path("edited.toml");
        fs::write(&path, text).unwrap();
        path
    }

    /// Returns the arguments of a command that begins a run.
    fn begin(&self, command: &str, run: &str, more: &[&str]) -> Vec<String> {
        let preset = self.preset.to_str().unwrap();
        self.begin_with(command, preset, run, more)
    }

    fn begin_with(&self, command: &str, preset: &str, run: &str, more: &[&str]) -> Vec<String> {
        let data = self.data.to_str().unwrap();
        let mut line = self.on(command, run, &["--preset", preset, "--data", data]);
        line.extend(more.iter().map(|&word| word.to_owned()));
        line
    }

    /// Returns the arguments of a command on a run.
    fn on(&self, command: &str, run: &str, more: &[&str]) -> Vec<String> {
        let run = self.path(run);
        let mut line = vec![command.to_owned(), "--run".to_owned()];
        line.push(run.to_str().unwrap().to_owned());
        line.extend(more.iter().map(|&word| word.to_owned()));
        line
    }

    /// Returns the resolved configuration of `train` with another seed.
    fn configuration(&self, seed: u64) -> RunContextParts {
        let mut preset = Preset::find(self.preset.to_str().unwrap()).unwrap();
        preset.seed = seed;
        let library = load(&self.data, &LoadOptions::default()).unwrap();
        let config = ResolvedConfig::new(preset, &library, Some(&self.data), false, None).unwrap();
        (config, library)
    }
}

type RunContextParts = (ResolvedConfig, recordings::Library);

/// Runs the program in this process.
fn run(line: &[String]) -> ExitCode {
    let words = std::iter::once("myointent".to_owned()).chain(line.iter().cloned());
    Cli::try_parse_from(words).unwrap().run()
}

fn succeeds(line: &[String]) {
    assert_eq!(run(line), ExitCode::SUCCESS, "{line:?}");
}

/// Asserts that a command fails with a message that has these words.
fn fails(line: &[String], words: &str) {
    let output = process(line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{line:?}: {message}");
    assert!(message.contains(words), "{line:?}: {message}");
}

fn are_wrong_arguments(line: &[String]) {
    assert_eq!(run(line), ExitCode::from(2), "{line:?}");
}

/// Builds the program's command in a process of its own: this test program, which starts with `child`.
fn process(line: &[String]) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", "child", "--ignored", "--nocapture"])
        .env(LINE, serde_json::to_string(line).unwrap())
        .env_remove("MYOINTENT_DATA");
    command
}

const LINE: &str = "MYOINTENT_TEST_LINE";

/// Runs the command line of the process that [`process`] starts. It is not a test.
#[test]
#[ignore = "other tests start it, as a process"]
fn child() {
    let Ok(line) = std::env::var(LINE) else {
        return;
    };
    let line: Vec<String> = serde_json::from_str(&line).unwrap();
    let words = std::iter::once("myointent".to_owned()).chain(line);
    let code = match Cli::try_parse_from(words) {
        Ok(cli) => cli.run(),
        Err(error) => error.exit(),
    };
    let known = [0, 1, 2, 130];
    let code = known
        .into_iter()
        .find(|&known| code == ExitCode::from(known));
    std::process::exit(code.map_or(99, i32::from));
}

#[test]
fn a_loss_that_is_no_number_stops_the_training() {
    let bench = Bench::new("diverged");
    let rates = [
        (
            "learning_rate = 1e-3\nlr_schedule",
            "learning_rate = 1e30\nlr_schedule",
        ),
        ("{ warm-up = 0.05 }", "\"constant\""),
    ];
    let preset = bench.edited(&rates);
    fails(
        &bench.begin_with("train", preset.to_str().unwrap(), "run", &[]),
        "so the training has diverged",
    );
    assert!(!bench.path("run/teacher.bpk").exists());
}

#[test]
fn a_student_that_no_board_runs_is_refused_before_training() {
    let bench = Bench::new("board");
    let wide = [(
        "d_model = 48\nheads = 4\nlayers = 2\nspan",
        "d_model = 96\nheads = 4\nlayers = 2\nspan",
    )];
    let preset = bench.edited(&wide);
    fails(
        &bench.begin_with("train", preset.to_str().unwrap(), "run", &[]),
        "no board can run this student",
    );
    assert!(!bench.path("run/teacher.bpk").exists());
    // The model format does not have these heads.
    let heads = [("heads = 4\nlayers = 2\nspan", "heads = 2\nlayers = 2\nspan")];
    let preset = bench.edited(&heads);
    fails(
        &bench.begin_with("train", preset.to_str().unwrap(), "run", &[]),
        "this student cannot become a model file",
    );
}

#[test]
fn sizes_that_no_memory_holds_are_refused() {
    let bench = Bench::new("sizes");
    let edits = [
        [("feed_forward = 64", "feed_forward = 4000000000000")],
        [("batch = 8", "batch = 8000000000")],
        [("patches = 100", "patches = 100000000000")],
        [("spliced_seconds = 20.0", "spliced_seconds = 1e15")],
        [("epochs = 1", "epochs = 9000000000000000000")],
    ];
    for edit in &edits {
        let preset = bench.edited(edit);
        let refused = Preset::find(preset.to_str().unwrap());
        assert!(refused.is_err(), "{edit:?}");
    }
}

#[test]
fn wrong_arguments_have_exit_code_2() {
    let bench = Bench::new("arguments");
    are_wrong_arguments(&bench.begin_with("train", "no-such-preset", "run", &[]));
    let fold = ["--protocol", "4-fold", "--fold", "9"];
    are_wrong_arguments(&bench.begin("train", "run", &fold));
    are_wrong_arguments(&["presets", "no-such-preset"].map(str::to_owned));
}

#[test]
fn an_empty_variable_names_no_recordings() {
    let bench = Bench::new("variable");
    let line = bench.on(
        "train",
        "run",
        &["--preset", bench.preset.to_str().unwrap()],
    );
    let child = process(&line)
        .env("MYOINTENT_DATA", "")
        .current_dir(&bench.folder)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&child.stderr);
    assert_eq!(child.status.code(), Some(0), "{message}");
    // The default is `./data`, as in quickstart, and the message says so.
    assert!(message.contains("recordings in data"), "{message}");
}
