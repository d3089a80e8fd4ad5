//! Ctrl-C: the program ends, viewers are told, and the shell sees that all is well.

use std::io::{BufRead as _, BufReader};
use std::process::{Command, ExitCode, Stdio};

use clap::Parser as _;
use myointent::cli::Cli;

use super::viewer::Viewer;

#[test]
fn ctrl_c_ends_the_program_in_order() {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "interrupt::demo", "--ignored", "--nocapture"])
        .env(CHILD, "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let url = lines.map_while(Result::ok).find_map(|line| {
        let at = line.find("http://")?;
        Some(line[at..].to_owned())
    });
    let mut viewer = Viewer::connect(&url.unwrap());
    viewer.find("samples", |_| true);
    let process = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &process]).status();
    assert!(sent.unwrap().success());
    viewer.find("end", |_| true);
    while viewer.next().is_some() {}
    assert!(child.wait().unwrap().success());
}

/// Set for the process alone: somebody may run all ignored tests.
const CHILD: &str = "MYOINTENT_TEST_LIVE";

#[test]
#[ignore = "the test above starts it, as a process"]
fn demo() {
    if std::env::var_os(CHILD).is_none() {
        return;
    }
    let line = ["myointent", "live", "--demo", "--listen", "127.0.0.1:0"];
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}
