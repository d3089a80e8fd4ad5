//! The program as a process: Ctrl-C ends it, viewers are told, and the shell sees that all is well; and in a terminal.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, ExitCode, Stdio};

use clap::Parser as _;
use myointent::cli::Cli;

use super::viewer::Viewer;

/// The address of the page that a program prints at its start.
pub fn address(program: &mut Child) -> String {
    let lines = BufReader::new(program.stdout.take().unwrap()).lines();
    let url = lines.map_while(Result::ok).find_map(|line| {
        let at = line.find("http://")?;
        Some(line[at..].to_owned())
    });
    url.unwrap()
}

#[test]
fn ctrl_c_ends_the_program_in_order() {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "interrupt::demo", "--ignored", "--nocapture"])
        .env(CHILD, "--listen 127.0.0.1:0")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut viewer = Viewer::connect(&address(&mut child));
    viewer.find("samples", |_| true);
    let process = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &process]).status();
    assert!(sent.unwrap().success());
    viewer.find("end", |_| true);
    while viewer.next().is_some() {}
    assert!(child.wait().unwrap().success());
}

#[cfg(target_os = "linux")]
#[test]
fn in_a_terminal_traces_and_labels_are_drawn_and_a_key_leaves_it_as_it_was() {
    use std::fs::File;
    use std::time::{Duration, Instant};

    let (mut screen, slave) = serial2::SerialPort::pair().unwrap();
    screen.set_read_timeout(Duration::from_millis(20)).unwrap();
    let path = myointent_tests::emulator::terminal(&slave);
    let terminal = || File::options().read(true).write(true).open(&path).unwrap();
    let size = Command::new("stty")
        .args(["rows", "30", "cols", "100"])
        .stdin(terminal())
        .status();
    assert!(size.unwrap().success());
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "interrupt::demo", "--ignored", "--nocapture"])
        .env(CHILD, "--tui")
        .stdin(terminal())
        .stdout(terminal())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (mut drawn, mut asked) = (String::new(), false);
    let end = Instant::now() + Duration::from_secs(60);
    let status = loop {
        let mut buffer = [0; 4096];
        if let Ok(length) = screen.read(&mut buffer) {
            drawn += &String::from_utf8_lossy(&buffer[..length]);
        }
        // A gesture is a label that a stream alone brings; traces are of braille dots.
        let is_shown = [
            "connected",
            "synthetic",
            "scores",
            "q quit",
            "OPEN",
            "CLOSE",
        ];
        let has_traces = drawn.contains(|letter| ('\u{2801}'..='\u{28ff}').contains(&letter));
        if !asked && has_traces && is_shown.iter().all(|text| drawn.contains(text)) {
            screen.write_all(b"q").unwrap();
            asked = true;
        }
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(Instant::now() < end, "{drawn}");
    };
    assert!(asked && status.success(), "{drawn}");
    // Entered and left: the alternate screen.
    let left = drawn.rfind("\u{1b}[?1049l").or_else(|| {
        let mut buffer = [0; 4096];
        let length = screen.read(&mut buffer).unwrap_or(0);
        drawn += &String::from_utf8_lossy(&buffer[..length]);
        drawn.rfind("\u{1b}[?1049l")
    });
    assert!(drawn.contains("\u{1b}[?1049h") && left.is_some(), "{drawn}");
}

/// Set for the process alone, more of its line: somebody may run all ignored tests.
const CHILD: &str = "MYOINTENT_TEST_LIVE";

#[test]
#[ignore = "the test above starts it, as a process"]
fn demo() {
    let Ok(more) = std::env::var(CHILD) else {
        return;
    };
    let line = ["myointent", "live", "--demo"].into_iter();
    let line = line.chain(more.split(' '));
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}
