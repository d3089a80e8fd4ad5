//! Run folders: their files, the process that works in them, and the state that a stopped program leaves behind.

#[path = "../small.rs"]
mod small;

mod belonging;
mod processes;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use presets::Preset;
use presets::config::ResolvedConfig;
use recordings::{LoadOptions, load};
use small::{folder, paths, process, recordings, run, small_preset};

/// Folder with recordings, `data`, and presets: `small.toml` and, once edited, `edited.toml`. In lines, `@name` is a path in it.
struct Bench {
    folder: PathBuf,
}

impl Bench {
    fn new(name: &str) -> Self {
        let folder = folder(name);
        recordings(&folder);
        small_preset(&folder);
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes the preset with some text replaced, which must be there.
    fn edit(&self, edits: &[(&str, &str)]) {
        let mut text = fs::read_to_string(self.path("small.toml")).unwrap();
        for (from, to) in edits {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        fs::write(self.path("edited.toml"), text).unwrap();
    }

    /// Returns the arguments of a command that begins a run.
    fn begin(&self, command: &str, run: &str, more: &str) -> String {
        self.begin_with(command, "@small.toml", run, more)
    }

    fn begin_with(&self, command: &str, preset: &str, run: &str, more: &str) -> String {
        let rest = format!("--preset {preset} --data @data {more}");
        self.on(command, run, &rest)
    }

    /// Returns the arguments of a command on a run.
    fn on(&self, command: &str, run: &str, more: &str) -> String {
        paths(&self.folder, &format!("{command} --run @{run} {more}"))
    }

    /// Returns the resolved configuration of `train` with another seed.
    fn configuration(&self, seed: u64) -> RunContextParts {
        let mut preset = Preset::find(self.path("small.toml").to_str().unwrap()).unwrap();
        preset.seed = seed;
        let data = self.path("data");
        let library = load(&data, &LoadOptions::default()).unwrap();
        let config = ResolvedConfig::new(preset, &library, Some(&data), false, None).unwrap();
        (config, library)
    }
}

type RunContextParts = (ResolvedConfig, recordings::Library);

fn succeeds(line: &str) {
    assert_eq!(run(line), ExitCode::SUCCESS, "{line:?}");
}

/// Asserts that a command fails with a message that has these words.
fn fails(line: &str, words: &str) {
    let output = process(line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{line:?}: {message}");
    assert!(message.contains(words), "{line:?}: {message}");
}

fn are_wrong_arguments(line: &str) {
    assert_eq!(run(line), ExitCode::from(2), "{line:?}");
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
    bench.edit(&rates);
    fails(
        &bench.begin_with("train", "@edited.toml", "run", ""),
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
    bench.edit(&wide);
    fails(
        &bench.begin_with("train", "@edited.toml", "run", ""),
        "no board can run this student",
    );
    assert!(!bench.path("run/teacher.bpk").exists());
    // The model format does not have these heads.
    let heads = [("heads = 4\nlayers = 2\nspan", "heads = 2\nlayers = 2\nspan")];
    bench.edit(&heads);
    fails(
        &bench.begin_with("train", "@edited.toml", "run", ""),
        "this student cannot become a model file",
    );
}

#[test]
fn wrong_arguments_have_exit_code_2() {
    let bench = Bench::new("arguments");
    are_wrong_arguments(&bench.begin_with("train", "no-such-preset", "run", ""));
    are_wrong_arguments(&bench.begin("train", "run", "--protocol 4-fold --fold 9"));
    are_wrong_arguments("presets no-such-preset");
}

#[test]
fn an_empty_variable_names_no_recordings() {
    let bench = Bench::new("variable");
    let line = bench.on("train", "run", "--preset @small.toml");
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
