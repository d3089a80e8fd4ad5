//! `myointent` as a process: lines of JSON for another program, Ctrl-C, a kill, and a disk that is full.

use std::io::{BufRead as _, BufReader, Lines};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::Parser as _;
use myointent::cli::{Cli, replay};
use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load};
use serde_json::Value;
use shared::uart_line::{Report, ReportKind};
use shared::units::Sample;

use super::record::{SHORT, assert_equal, reach, recorded, wish};
use super::shipped;
use super::viewer::Viewer;

/// Longest wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Environment variable with the command line, set for the child process alone: somebody may run all ignored tests.
const CHILD: &str = "MYOINTENT_TEST_COMMAND";

#[test]
#[ignore = "the other tests start it, as a process"]
fn child() {
    let Ok(arguments) = std::env::var(CHILD) else {
        return;
    };
    let line = std::iter::once("myointent").chain(arguments.split(' '));
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}

/// Starts `myointent` with these arguments, after the shell commands `shell`.
fn start(shell: &str, arguments: &str) -> Child {
    Command::new("sh")
        .args(["-c", &format!("{shell} exec \"$0\" \"$@\"")])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "process::child", "--ignored", "--nocapture"])
        .env(CHILD, arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Sends Ctrl-C.
fn interrupt(child: &Child) {
    let process = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &process]).status();
    assert!(sent.unwrap().success());
}

/// Waits for the end of a program; returns its exit code and its standard error.
fn ended(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), told)
}

/// Writes a synthetic recording of so many seconds; returns its path and its samples.
fn written(seconds: usize, folder: &std::path::Path) -> (PathBuf, Vec<Sample>) {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds,
        ..SynthOptions::default()
    };
    let path = synthetic::write(&options, folder).unwrap().remove(0);
    let mut library = load(&path, &LoadOptions::default()).unwrap();
    (path, library.recordings.remove(0).samples)
}

/// Program, and the pipe that its lines come through.
struct Program {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Program {
    fn start(arguments: &str) -> Self {
        let mut child = start("", &format!("live --json {arguments}"));
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, lines }
    }

    /// Returns the next message; `None` at the end. The program is a test here, whose harness writes before it.
    fn next(&mut self) -> Option<Value> {
        self.lines.by_ref().map_while(Result::ok).find_map(|line| {
            let message = serde_json::from_str(&line[line.find('{')?..]).unwrap();
            assert_documented(&message);
            Some(message)
        })
    }

    fn find(&mut self, kind: &str) -> Value {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            let message = self.next().expect("a message, not the end");
            if message["type"] == kind {
                return message;
            }
        }
        panic!("no message of type {kind}");
    }

    /// Closes the pipe; returns the exit code and the standard error.
    fn close(self) -> (Option<i32>, String) {
        drop(self.lines);
        ended(self.child)
    }
}

/// Asserts that docs/live.md has a row for the message, with all its fields.
fn assert_documented(message: &Value) {
    let page = include_str!("../../docs/live.md");
    let start = format!("| `{}` |", message["type"].as_str().unwrap());
    let mut rows = page.lines().filter(|line| line.starts_with(&start));
    let row = rows
        .next()
        .unwrap_or_else(|| panic!("no row for {message}"));
    for field in message.as_object().unwrap().keys() {
        let told = field == "type" || row.contains(&format!("`{field}`"));
        assert!(told, "{field} is not in {row}");
    }
}

#[test]
fn samples_and_labels_are_those_of_replay_and_a_closed_pipe_is_success() {
    let folder = tempfile::tempdir().unwrap();
    let (path, samples) = written(6, folder.path());
    let replayed = replay::lines(&shipped(), &samples).unwrap();
    let expected = replayed.lines().map(|line| {
        let report = Report::parse(format!("{line}\r\n").as_bytes()).unwrap();
        serde_json::json!([
            report.kind == ReportKind::Label,
            report.sequence,
            report.instant.0,
            report.emitted.0,
            report.status.label().name(),
            report.status.valid(),
        ])
    });
    let expected: Vec<Value> = expected.collect();
    assert!(expected.len() > 10);

    let mut program = Program::start(&format!("--replay {}", path.display()));
    let source = program.next().unwrap();
    assert_eq!(
        (&source["type"], &source["kind"], &source["connected"]),
        (&"source".into(), &"replay".into(), &true.into())
    );
    let model = program.next().unwrap();
    assert_eq!(
        model["classes"],
        serde_json::json!(["relax", "open", "close"])
    );
    let (mut found, mut emg, mut scores) = (Vec::<Value>::new(), Vec::new(), 0);
    loop {
        let message = program.next().unwrap();
        match message["type"].as_str().unwrap() {
            "samples" => {
                assert_eq!(message["first"], emg.len());
                emg.extend_from_slice(message["emg"].as_array().unwrap());
            }
            "report" => {
                let fields = ["is_label", "number", "instant", "emitted", "label", "valid"];
                found.push(fields.map(|field| message[field].clone()).to_vec().into());
            }
            "scores" => scores += 1,
            // Those of a gesture, after a rest.
            "electrodes" => assert!(message["times"].is_array(), "{message}"),
            "mark" => break,
            other => panic!("{other}: {message}"),
        }
    }
    assert_eq!(found, expected);
    assert_eq!(Value::from(emg), serde_json::to_value(samples).unwrap());
    assert!(scores > 100, "{scores}");
    // The recording repeats for ever, so the program does not end by itself.
    let (code, said) = program.close();
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn a_closed_pipe_ends_a_program_that_has_nothing_to_say() {
    let mut program = Program::start("--port /dev/myointent-nothing");
    let source = program.next().unwrap();
    assert_eq!(source["connected"], false);
    assert_eq!(program.find("quiet")["type"], "quiet");
    let (code, said) = program.close();
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn ctrl_c_ends_lines_and_page_with_a_message_that_says_so() {
    // The program has no socket open: it serves no page.
    #[cfg(target_os = "linux")]
    {
        let mut program = Program::start("--demo");
        program.find("samples");
        let open = std::fs::read_dir(format!("/proc/{}/fd", program.child.id())).unwrap();
        let open = open.flatten().flat_map(|file| file.path().read_link());
        let sockets = open.filter(|file| file.to_string_lossy().starts_with("socket:"));
        assert_eq!(sockets.count(), 0);
        program.close();
    }
    let mut program = Program::start("--demo --listen 127.0.0.1:0");
    program.find("samples");
    let said = BufReader::new(program.child.stderr.take().unwrap()).lines();
    let url = said.map_while(Result::ok).find_map(|line| {
        let url = line.strip_prefix("page: ")?;
        Some(url.to_owned())
    });
    let mut viewer = Viewer::connect(&url.unwrap());
    viewer.say(r#"{"do":"align"}"#);
    assert_eq!(program.find("alignment")["state"], "waiting");
    interrupt(&program.child);
    viewer.find("end", |_| true);
    while viewer.next().is_some() {}
    program.find("end");
    assert_eq!(program.next(), None);
    assert!(program.child.wait().unwrap().success());
}

#[test]
fn what_goes_wrong_is_said_on_standard_error_and_by_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("damaged.intent");
    let mut bytes = shipped();
    bytes[100] ^= 1;
    std::fs::write(&model, bytes).unwrap();
    let mut program = Program::start(&format!("--demo --model {}", model.display()));
    assert_eq!(program.next(), None);
    let (code, said) = program.close();
    assert!(code == Some(1) && said.contains("checksum"), "{said}");
}

/// Recording to play, a protocol, and a folder to record to.
struct Bench {
    folder: tempfile::TempDir,
    played: PathBuf,
    samples: Vec<Sample>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (played, samples) = written(20, &folder.path().join("played"));
        std::fs::write(folder.path().join("short.toml"), SHORT).unwrap();
        Self {
            folder,
            played,
            samples,
        }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Length of each journal.
    fn journals(&self) -> Vec<u64> {
        let files = std::fs::read_dir(self.out().join("anna")).unwrap();
        let paths = files.flatten().map(|file| file.path());
        let is_journal = |path: &PathBuf| path.extension().is_some_and(|own| own == "journal");
        let journals = paths.filter(is_journal);
        journals
            .map(|path| path.metadata().unwrap().len())
            .collect()
    }

    /// Starts `myointent record` after the shell commands `shell`, and begins the session as a viewer once samples come.
    fn start(&self, shell: &str) -> (Child, Viewer) {
        let line = format!(
            "record --person anna --speed 16 --listen 127.0.0.1:0 --replay {} --out {} --protocol {}",
            self.played.display(),
            self.out().display(),
            self.folder.path().join("short.toml").display(),
        );
        let mut child = start(shell, &line);
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let url = lines.map_while(Result::ok).find_map(|line| {
            let at = line.find("http://")?;
            Some(line[at..].to_owned())
        });
        let mut viewer = Viewer::connect(&url.unwrap());
        viewer.find("samples", |_| true);
        wish(&mut viewer, "begin");
        (child, viewer)
    }
}

#[test]
fn a_process_that_is_killed_in_a_session_loses_a_moment_and_the_next_start_keeps_the_rest() {
    let bench = Bench::new();
    let (mut child, mut viewer) = bench.start("");
    reach(&mut viewer, |message| message["cue"] == "close");
    let seen = viewer.find("samples", |_| true)["first"].as_u64().unwrap() as usize;
    // What the recorder has is written every 0.2 s of the process (docs/record.md): the second time, all that was seen.
    for _ in 0..2 {
        let before = bench.journals();
        let begun = Instant::now();
        while bench.journals() == before {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "nothing more is written"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    // SIGKILL: the process can do nothing more.
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(bench.journals().len(), 1);
    let kept = myointent::record::recover(&bench.out().join("anna")).unwrap();
    assert!(matches!(&kept[..], [(_, Ok(_))]), "{kept:?}");
    assert!(bench.journals().is_empty());
    let files = recorded(&bench.out());
    assert_equal(&files, &bench.samples);
    let last = *files.last().unwrap().keys().last().unwrap();
    assert!(last >= seen, "{last} of {seen}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_holds_the_session_and_with_room_again_nothing_is_missing() {
    let bench = Bench::new();
    // A limit on the size of files stands for the full disk: the journal cannot grow, and its signal must end nothing.
    let (mut child, mut viewer) = bench.start("ulimit -S -f 100;");
    let (told, _) = reach(&mut viewer, |message| !message["trouble"].is_null());
    let trouble = told["trouble"]["text"].as_str().unwrap();
    assert!(trouble.contains("what was recorded is kept"), "{trouble}");
    assert_eq!(
        (&told["phase"], &told["why"]),
        (&"held".into(), &"disk".into())
    );
    let limit = Command::new("prlimit")
        .args(["--pid", &child.id().to_string(), "--fsize=unlimited"])
        .status();
    if !limit.is_ok_and(|status| status.success()) {
        myointent_tests::skip("no prlimit");
        child.kill().unwrap();
        child.wait().unwrap();
        return;
    }
    viewer.find("session", |message| message["trouble"].is_null());
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["cue"] == "close");
    wish(&mut viewer, "finish");
    let kept = viewer.find("kept", |_| true);
    assert!(kept["files"].as_array().unwrap().len() >= 2, "{kept}");
    interrupt(&child);
    let (code, told) = ended(child);
    assert_eq!(code, Some(0), "{told}");
    let files = recorded(&bench.out());
    assert_equal(&files, &bench.samples);
    // All samples are there up to the moment that the session was held at, which was not written when the disk was
    // full.
    assert!(files[0].len() > 1000, "{}", files[0].len());
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_on_a_full_disk_fails_and_the_terminal_says_what_is_not_kept_and_where_the_rest_is() {
    let bench = Bench::new();
    let (child, mut viewer) = bench.start("ulimit -S -f 100;");
    reach(&mut viewer, |message| !message["trouble"].is_null());
    interrupt(&child);
    let (code, told) = ended(child);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains(".journal"), "{told}");
    assert_eq!(bench.journals().len(), 1, "{told}");
}

#[test]
fn a_session_whose_recordings_cannot_be_made_fails_the_program_after_the_next_one_too() {
    let bench = Bench::new();
    let (child, mut viewer) = bench.start("");
    reach(&mut viewer, |message| message["cue"] == "open");
    let files = std::fs::read_dir(bench.out().join("anna")).unwrap();
    let mut paths = files.map(|file| file.unwrap().path());
    let journal = paths.find(|path| path.extension().is_some_and(|ending| ending == "journal"));
    let journal = journal.unwrap().display().to_string();
    let taken = journal.replace(".journal", "_1.csv");
    std::fs::write(&taken, "somebody's").unwrap();
    wish(&mut viewer, "finish");
    viewer.find("session", |message| message["trouble"] != "");
    wish(&mut viewer, "again");
    viewer.find("session", |message| message["phase"] == "waiting");
    interrupt(&child);
    let (code, told) = ended(child);
    assert!(code == Some(1) && told.contains(&journal), "{told}");
    assert_eq!(bench.journals().len(), 1);
}

#[test]
fn a_folder_that_is_deleted_in_a_session_holds_it_and_nothing_is_missing_at_the_end() {
    let bench = Bench::new();
    let (child, mut viewer) = bench.start("");
    reach(&mut viewer, |message| message["cue"] == "open");
    // One rename: the recorder writes a new journal where it finds none, even into a folder that is being emptied.
    let deleted = bench.folder.path().join("deleted");
    std::fs::rename(bench.out().join("anna"), &deleted).unwrap();
    std::fs::remove_dir_all(deleted).unwrap();
    let held = viewer.find("session", |message| message["phase"] == "held");
    assert_eq!(held["why"], "gone", "{held}");
    // It goes on, and Ctrl-C ends it.
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["cue"] == "close");
    interrupt(&child);
    let (code, told) = ended(child);
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("written anew"), "{told}");
    let files = recorded(&bench.out());
    assert_equal(&files, &bench.samples);
    assert!(files.len() > 1, "what came after the hold is missing");
    // The journal has the samples from the countdown on, from before the folder was deleted.
    assert!(files[0].len() > 200, "{}", files[0].len());
}
