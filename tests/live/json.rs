//! `myointent live --json` as a process, read by another program.

use std::io::{BufRead as _, BufReader, Lines, Read as _};
use std::process::{Child, ChildStdout, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use myointent::cli::replay;
use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load};
use serde_json::Value;
use shared::uart_line::{Report, ReportKind};

use super::interrupt::{interrupt, live};
use super::shipped;
use super::viewer::Viewer;

/// Longest wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Program, and the pipe that its lines come through.
struct Program {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Program {
    fn start(arguments: &str) -> Self {
        let mut child = live(arguments).stderr(Stdio::piped()).spawn().unwrap();
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

    /// Closes the pipe.
    fn close(self) -> Child {
        self.child
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

/// Waits for the end of a program; returns its status and its standard error.
fn ended(mut child: Child) -> (ExitStatus, String) {
    let end = Instant::now() + PATIENCE;
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if Instant::now() > end {
            child.kill().unwrap();
            panic!("the program goes on");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let mut text = String::new();
    child.stderr.unwrap().read_to_string(&mut text).unwrap();
    (status, text)
}

#[test]
fn samples_and_labels_are_those_of_replay_and_a_closed_pipe_is_success() {
    let folder = tempfile::tempdir().unwrap();
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 6,
        ..SynthOptions::default()
    };
    let path = synthetic::write(&options, folder.path()).unwrap().remove(0);
    let library = load(&path, &LoadOptions::default()).unwrap();
    let samples = &library.recordings[0].samples;
    let replayed = replay::lines(&shipped(), samples).unwrap();
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

    let mut program = Program::start(&format!("--json --replay {}", path.display()));
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
    let (status, said) = ended(program.close());
    assert!(status.success(), "{said}");
}

#[test]
fn a_closed_pipe_ends_a_program_that_has_nothing_to_say() {
    let mut program = Program::start("--json --port /dev/myointent-nothing");
    let source = program.next().unwrap();
    assert_eq!(source["connected"], false);
    assert_eq!(program.find("quiet")["type"], "quiet");
    let (status, said) = ended(program.close());
    assert!(status.success(), "{said}");
}

#[test]
fn ctrl_c_ends_the_lines_with_one_that_says_so() {
    let mut program = Program::start("--json --demo");
    program.find("samples");
    // The program has no socket open: it serves no page.
    #[cfg(target_os = "linux")]
    {
        let open = std::fs::read_dir(format!("/proc/{}/fd", program.child.id())).unwrap();
        let open = open.flatten().flat_map(|file| file.path().read_link());
        let sockets = open.filter(|file| file.to_string_lossy().starts_with("socket:"));
        assert_eq!(sockets.count(), 0);
    }
    interrupt(&program.child);
    program.find("end");
    assert_eq!(program.next(), None);
    let (status, said) = ended(program.close());
    assert!(status.success(), "{said}");
}

#[test]
fn with_an_address_there_is_a_page_too() {
    let mut program = Program::start("--json --demo --listen 127.0.0.1:0");
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
    program.find("end");
    assert!(program.child.wait().unwrap().success());
}

#[test]
fn what_goes_wrong_is_said_on_standard_error_and_by_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("damaged.intent");
    let mut bytes = shipped();
    bytes[100] ^= 1;
    std::fs::write(&model, bytes).unwrap();
    let mut program = Program::start(&format!("--json --demo --model {}", model.display()));
    assert_eq!(program.next(), None);
    let (status, said) = ended(program.close());
    assert!(!status.success() && said.contains("checksum"), "{said}");
}
