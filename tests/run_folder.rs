//! Run folders: what belongs together, who works in them, and what a stopped program leaves behind.

#[path = "small.rs"]
mod small;

use std::fs;
use std::io::BufRead as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use burn::tensor::Device;
use clap::Parser as _;
use execution::run_folder::RunFolder;
use myointent::cli::Cli;
use presets::Preset;
use presets::config::ResolvedConfig;
use recordings::{LoadOptions, load};
use shared::model::file::Model;
use small::{folder, myointent, recordings, small_preset};
use training::run::context::RunContext;

/// A folder with recordings and a preset.
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

    /// The preset with some text replaced, which must be there.
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

    /// Arguments of a command that begins a run.
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

    /// Arguments of a command on a run.
    fn on(&self, command: &str, run: &str, more: &[&str]) -> Vec<String> {
        let run = self.path(run);
        let mut line = vec![command.to_owned(), "--run".to_owned()];
        line.push(run.to_str().unwrap().to_owned());
        line.extend(more.iter().map(|&word| word.to_owned()));
        line
    }

    /// The resolved configuration of `train` with another seed.
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

/// Fails with a message that has these words.
fn fails(line: &[String], words: &str) {
    let output = process(line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{line:?}: {message}");
    assert!(message.contains(words), "{line:?}: {message}");
}

fn are_wrong_arguments(line: &[String]) {
    assert_eq!(run(line), ExitCode::from(2), "{line:?}");
}

/// The program in a process of its own: this test program, which starts with `child`.
fn process(line: &[String]) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", "child", "--ignored", "--nocapture"])
        .env(LINE, serde_json::to_string(line).unwrap())
        .env_remove("MYOINTENT_DATA");
    command
}

const LINE: &str = "MYOINTENT_TEST_LINE";

/// Not a test: the process that [`process`] starts.
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

/// The scores in a model file's header.
fn figures(file: &Path) -> Vec<(String, f32)> {
    let bytes = fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let metrics = model.header.provenance.metrics;
    metrics
        .iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn weights(run: &Path) -> Vec<u8> {
    assert!(myointent(&["export", "--run", run.to_str().unwrap()]));
    fs::read(run.join("teacher.safetensors")).unwrap()
}

#[test]
fn a_student_of_another_split_is_neither_evaluated_nor_quantized() {
    let bench = Bench::new("other-split");
    let fold = |number| ["--protocol", "2-fold", "--fold", number];
    succeeds(&bench.begin("train", "run", &fold("1")));
    succeeds(&bench.on("quantize", "run", &[]));
    let second = [&fold("2")[..], &["--overwrite", "--teacher-only"]].concat();
    succeeds(&bench.begin("train", "run", &second));
    fails(
        &bench.on("evaluate", "run", &[]),
        "student.bpk does not belong",
    );
    fails(
        &bench.on("quantize", "run", &[]),
        "student.bpk does not belong",
    );
    succeeds(&bench.on("train", "run", &["--resume"]));
    // The model file is still the first student's.
    fails(
        &bench.on("evaluate", "run", &[]),
        "student.intent is not the model file",
    );
    succeeds(&bench.on("quantize", "run", &[]));
    succeeds(&bench.on("evaluate", "run", &[]));
}

#[test]
fn a_student_does_not_belong_to_a_teacher_that_it_did_not_learn_from() {
    let bench = Bench::new("other-teacher");
    succeeds(&bench.begin("train", "run", &[]));
    succeeds(&bench.on("quantize", "run", &[]));
    let preset = bench.edited(&[("stride = 600", "stride = 300")]);
    let only = ["--overwrite", "--teacher-only"];
    succeeds(&bench.begin_with("train", preset.to_str().unwrap(), "run", &only));
    fails(
        &bench.on("evaluate", "run", &[]),
        "student.bpk does not belong",
    );
}

#[test]
fn resume_does_not_take_the_weights_of_the_run_before() {
    let bench = Bench::new("fresh");
    succeeds(&bench.begin("train", "run", &[]));
    // A fresh start that is stopped in its first epoch.
    let (config, library) = bench.configuration(7);
    let folder = RunFolder::open(bench.path("run")).unwrap();
    drop(RunContext::begin(folder, config, library, Device::default().autodiff()).unwrap());
    succeeds(&bench.on("train", "run", &["--resume"]));
    succeeds(&bench.begin("train", "honest", &["--seed", "7"]));
    let same = weights(&bench.path("run")) == weights(&bench.path("honest"));
    assert!(same, "the resumed run has other weights");
}

#[test]
fn resume_is_refused_with_another_configuration() {
    let bench = Bench::new("resume");
    let seven = ["--seed", "7"];
    let resumed = [&seven[..], &["--resume"]].concat();
    for command in ["train", "quickstart"] {
        succeeds(&bench.begin(command, command, &seven));
        succeeds(&bench.begin(command, command, &resumed));
        fails(
            &bench.begin(command, command, &["--seed", "8", "--resume"]),
            "(seed 7 / 8)",
        );
    }
    // What an interrupted command advises is the same command with --resume.
    let fold = ["--protocol", "2-fold", "--fold", "1"];
    succeeds(&bench.begin("train", "fold", &fold));
    succeeds(&bench.begin("train", "fold", &[&fold[..], &["--resume"]].concat()));
}

#[test]
fn a_run_is_not_replaced_by_a_second_one() {
    let bench = Bench::new("second");
    for command in ["train", "quickstart"] {
        succeeds(&bench.begin(command, command, &[]));
        let content = |name: &str| fs::read(bench.path(command).join(name)).unwrap();
        let before = content("config.json");
        // The same command, and one of another run.
        for more in [&[][..], &["--seed", "7"]] {
            fails(&bench.begin(command, command, more), "--overwrite");
        }
        assert!(content("config.json") == before, "{command}");
        succeeds(&bench.begin(command, command, &["--seed", "7", "--overwrite"]));
        assert!(content("config.json") != before, "{command}");
    }
    // What another command of the same folder has written is somebody's, too.
    let foreign = bench.path("foreign");
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("student.intent"), "somebody's").unwrap();
    fails(&bench.begin("quickstart", "foreign", &[]), "student.intent");
    assert_eq!(
        fs::read(foreign.join("student.intent")).unwrap(),
        b"somebody's"
    );
}

#[test]
fn a_model_and_a_recording_are_never_replaced_by_what_a_command_writes() {
    let bench = Bench::new("outputs");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/three-class.intent");
    let model = bench.path("mine.intent");
    fs::copy(&shipped, &model).unwrap();
    let recording = bench.data.join("s1/s1_synthetic_1.csv");
    let [shipped, model, recording, data] =
        [&shipped, &model, &recording, &bench.data].map(|path| path.to_str().unwrap());
    let line = |words: &[&str]| {
        words
            .iter()
            .map(|&word| word.to_owned())
            .collect::<Vec<_>>()
    };
    let (labels, page) = (bench.path("labels.csv"), bench.path("page.html"));
    let [labels, page] = [&labels, &page].map(|path| path.to_str().unwrap());
    let content = |path: &str| fs::read(path).unwrap();
    let before = [content(model), content(recording)];

    let gate = |out| line(&["gate", shipped, "--other", "1", "--out", out]);
    fails(&gate(model), "exists already");
    let predict = |out| {
        line(&[
            "predict",
            "--model",
            shipped,
            "--recording",
            recording,
            "--out",
            out,
        ])
    };
    fails(&predict(recording), "exists already");
    let report = |out| line(&["report", shipped, "--data", data, "--out", out]);
    fails(&report(recording), "exists already");
    assert!(before == [content(model), content(recording)]);

    // An earlier output of the same kind is replaced.
    for _ in 0..2 {
        succeeds(&predict(labels));
        succeeds(&report(page));
    }
    fails(&predict(page), "expected a name that ends in");
    fails(&report(labels), "no earlier output");
}

#[test]
fn figures_of_another_model_are_not_written_into_the_runs_own() {
    let bench = Bench::new("figures");
    succeeds(&bench.begin("quickstart", "other", &["--seed", "7"]));
    succeeds(&bench.begin("quickstart", "run", &[]));
    let (own, other) = (
        bench.path("run/student.intent"),
        bench.path("other/student.intent"),
    );
    let honest = figures(&own);
    assert_ne!(
        honest,
        figures(&other),
        "the test needs two models that differ"
    );
    succeeds(&bench.on("evaluate", "run", &["--model", other.to_str().unwrap()]));
    succeeds(&bench.on("quantize", "run", &[]));
    assert_eq!(figures(&own), honest);
}

#[test]
fn a_preset_without_a_teacher_trains_one_if_asked() {
    let bench = Bench::new("extra");
    let preset = bench.edited(&[("teacher_share = 0.5", "teacher_share = 0.0")]);
    let begin = |run, more: &[&str]| {
        succeeds(&bench.begin_with("train", preset.to_str().unwrap(), run, more));
    };
    let has = |run: &str, name: &str| bench.path(run).join(name).exists();
    begin("student", &[]);
    assert!(!has("student", "teacher.bpk") && has("student", "student.bpk"));
    begin("both", &["--teacher", "--labels-only"]);
    assert!(has("both", "teacher.bpk") && has("both", "student-alone.bpk"));
    begin("teacher", &["--teacher-only"]);
    assert!(has("teacher", "teacher.bpk") && !has("teacher", "student.bpk"));
    succeeds(&bench.on("train", "teacher", &["--resume"]));
    assert!(has("teacher", "student.bpk"));
}

#[test]
fn an_ensemble_goes_on_where_it_was_interrupted() {
    let bench = Bench::new("ensemble");
    let edited = bench.edited(&[(
        "temperature = 2.0",
        "temperature = 2.0\nensemble = { members = 2, epochs = 2 }",
    )]);
    let preset = edited.to_str().unwrap();
    succeeds(&bench.begin_with("quickstart", preset, "run", &[]));
    let run = bench.path("run");
    let content = |name: &str| fs::read(run.join(name)).unwrap();
    assert!(!run.join("teacher.bpk").exists());
    assert_ne!(content("member-1.bpk"), content("member-2.bpk"));
    assert_eq!(content("member-1.jsonl").as_slice().lines().count(), 2);
    assert_eq!(content("student.jsonl").as_slice().lines().count(), 1);
    let whole = content("student.intent");
    for name in ["member-2", "student"] {
        for ending in ["bpk", "checkpoint", "jsonl"] {
            fs::remove_file(run.join(format!("{name}.{ending}"))).unwrap();
        }
    }
    succeeds(&bench.on("train", "run", &["--resume"]));
    succeeds(&bench.on("quantize", "run", &[]));
    assert!(content("student.intent") == whole);
}

#[test]
fn a_second_process_is_refused_while_a_run_is_being_made() {
    let bench = Bench::new("lock");
    let (config, library) = bench.configuration(7);
    let folder = RunFolder::open(bench.path("run")).unwrap();
    let first = RunContext::begin(folder, config, library, Device::default().autodiff()).unwrap();
    let second = bench.begin("train", "run", &["--overwrite"]);
    let second = process(&second).output().unwrap();
    let message = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{message}");
    let pid = std::process::id().to_string();
    assert!(
        message.contains(&pid) && message.contains("since"),
        "{message}"
    );
    drop(first);
    succeeds(&bench.begin("train", "run", &["--overwrite"]));
}

#[test]
fn a_killed_process_leaves_no_lock() {
    let bench = Bench::new("killed");
    let mut first = process(&bench.begin("quickstart", "run", &[]))
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
    succeeds(&bench.begin("quickstart", "run", &["--resume"]));
    let left = fs::read_dir(bench.path("run")).unwrap();
    let partial = left
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .find(|name| name.contains("partial"));
    assert_eq!(partial, None);
}

#[test]
fn an_interrupted_command_advises_what_it_has() {
    let bench = Bench::new("interrupt");
    let preset = bench.edited(&[("epochs = 1", "epochs = 1000")]);
    let line = bench.begin_with("train", preset.to_str().unwrap(), "run", &[]);
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
    // Not complete: there is nothing to quantize.
    fails(&bench.on("quantize", "run", &[]), "not trained yet");
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
    // Heads that the model format does not have.
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
    // `./data`, as in quickstart, and it says so.
    assert!(message.contains("recordings in data"), "{message}");
}

#[test]
fn a_closed_standard_error_is_no_panic() {
    let bench = Bench::new("stderr");
    let mut child = process(&bench.begin("train", "run", &[]))
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
        myointent_tests::skip("revision", "no git");
        return;
    }
    let revision = |run: &str, at: &Path| {
        let line = bench.begin("train", run, &[]);
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
    // In its repository the program knows the commit; whether there are changes depends on who works there.
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        command
            .args(arguments)
            .current_dir(source)
            .output()
            .unwrap()
    };
    if git(&["ls-files", "--error-unmatch", "Cargo.toml"])
        .status
        .success()
    {
        let commit = git(&["describe", "--always", "--abbrev=12"]).stdout;
        let commit = String::from_utf8(commit).unwrap();
        let known = here.as_str().unwrap_or_default();
        assert!(known.starts_with(commit.trim()), "{known}, {commit}");
    }
}
