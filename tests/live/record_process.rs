//! `myointent record` as a process: killed in a session, and on a disk that is full.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};

use clap::Parser as _;
use myointent::cli::Cli;
use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load};
use shared::units::Sample;

use super::interrupt::address;
use super::record::{SHORT, assert_equal, reach, recorded, wish};
use super::viewer::Viewer;

/// Recording to play, a protocol, and a folder to record to.
struct Bench {
    folder: tempfile::TempDir,
    played: PathBuf,
    samples: Vec<Sample>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let options = SynthOptions {
            subjects: 1,
            recordings: 1,
            seconds: 20,
            ..SynthOptions::default()
        };
        let played = synthetic::write(&options, &folder.path().join("played"))
            .unwrap()
            .remove(0);
        let samples = load(&played, &LoadOptions::default())
            .unwrap()
            .recordings
            .remove(0)
            .samples;
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

    fn journals(&self) -> usize {
        let files = std::fs::read_dir(self.out().join("anna"))
            .unwrap()
            .flatten();
        files
            .filter(|file| {
                file.path()
                    .extension()
                    .is_some_and(|ending| ending == "journal")
            })
            .count()
    }

    /// Starts the program after the shell commands `shell`, and begins the session as a viewer once samples come.
    fn start(&self, shell: &str) -> (Child, Viewer) {
        let line = format!(
            "--person anna --speed 16 --listen 127.0.0.1:0 --replay {} --out {} --protocol {}",
            self.played.display(),
            self.out().display(),
            self.folder.path().join("short.toml").display(),
        );
        let mut child = Command::new("sh")
            .args(["-c", &format!("{shell} exec \"$0\" \"$@\"")])
            .arg(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "record_process::child",
                "--ignored",
                "--nocapture",
            ])
            .env(CHILD, line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut viewer = Viewer::connect(&address(&mut child));
        viewer.find("samples", |_| true);
        wish(&mut viewer, "begin");
        (child, viewer)
    }
}

/// Sends Ctrl-C; returns the exit code and what the terminal shows.
fn interrupt(child: Child) -> (Option<i32>, String) {
    let process = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &process]).status();
    assert!(sent.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), told)
}

fn last_sample(folder: &Path) -> usize {
    *recorded(folder).last().unwrap().keys().last().unwrap()
}

#[test]
fn a_process_that_is_killed_in_a_session_loses_a_moment_and_the_next_start_keeps_the_rest() {
    let bench = Bench::new();
    let (mut child, mut viewer) = bench.start("");
    reach(&mut viewer, |message| message["cue"] == "close");
    let seen = viewer.find("samples", |_| true)["first"].as_u64().unwrap() as usize;
    // SIGKILL: the process can do nothing more.
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(bench.journals(), 1);
    let kept = myointent::record::recover(&bench.out().join("anna")).unwrap();
    assert!(matches!(&kept[..], [(_, Ok(_))]), "{kept:?}");
    assert_eq!(bench.journals(), 0);
    assert_equal(&recorded(&bench.out()), &bench.samples);
    // The loss at 16 times an armband's speed: 0.2 s of the process (docs/record.md), a line of 20 samples and what the
    // recorder had not yet been handed.
    let last = last_sample(&bench.out());
    assert!(last + 16 * 40 > seen, "{last} of {seen}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_holds_the_session_and_with_room_again_nothing_is_missing() {
    let bench = Bench::new();
    // A limit on the size of files stands for the full disk: the journal cannot grow, and its signal must end nothing.
    let (mut child, mut viewer) = bench.start("ulimit -S -f 100;");
    let (told, _) = reach(&mut viewer, |message| message["trouble"] != "");
    let trouble = told["trouble"].as_str().unwrap();
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
    viewer.find("session", |message| message["trouble"] == "");
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["cue"] == "close");
    wish(&mut viewer, "finish");
    let kept = viewer.find("kept", |_| true);
    assert!(kept["files"].as_array().unwrap().len() >= 2, "{kept}");
    let (code, told) = interrupt(child);
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
    reach(&mut viewer, |message| message["trouble"] != "");
    let (code, told) = interrupt(child);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains(".journal"), "{told}");
    assert_eq!(bench.journals(), 1, "{told}");
}

#[test]
fn recordings_that_cannot_be_written_fail_the_program_after_they_were_told_on_the_page() {
    let bench = Bench::new();
    let (child, mut viewer) = bench.start("");
    reach(&mut viewer, |message| message["cue"] == "open");
    let journal = std::fs::read_dir(bench.out().join("anna"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|ending| ending == "journal"))
        .unwrap();
    let stem = journal.file_stem().unwrap().to_str().unwrap();
    let taken = journal.with_file_name(format!("{stem}_1.csv"));
    std::fs::write(&taken, "somebody's").unwrap();
    wish(&mut viewer, "finish");
    viewer.find("session", |message| message["trouble"] != "");
    wish(&mut viewer, "again");
    viewer.find("session", |message| message["phase"] == "waiting");
    let (code, told) = interrupt(child);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains(journal.to_str().unwrap()), "{told}");
    assert_eq!(std::fs::read(&taken).unwrap(), b"somebody's");
    assert_eq!(bench.journals(), 1);
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
    wish(&mut viewer, "begin");
    reach(&mut viewer, |message| message["cue"] == "close");
    wish(&mut viewer, "finish");
    let kept = viewer.find("kept", |_| true);
    assert!(kept["files"].as_array().unwrap().len() >= 2, "{kept}");
    let (code, told) = interrupt(child);
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("written anew"), "{told}");
    let files = recorded(&bench.out());
    assert_equal(&files, &bench.samples);
    // The journal has the samples from the countdown on, from before the folder was deleted.
    assert!(files[0].len() > 200, "{}", files[0].len());
}

/// Environment variable with the rest of the command line, set for the child process alone: somebody may run all
/// ignored tests.
const CHILD: &str = "MYOINTENT_TEST_RECORD";

#[test]
#[ignore = "the tests above start it, as a process"]
fn child() {
    let Ok(more) = std::env::var(CHILD) else {
        return;
    };
    let line = ["myointent", "record"].into_iter();
    let line = line.chain(more.split(' '));
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}
