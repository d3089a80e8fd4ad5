//! Program as a process: Ctrl-C ends it, viewers are told, and its exit code is that of success.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, ExitCode, Stdio};

use clap::Parser as _;
use myointent::cli::Cli;

use super::viewer::Viewer;

/// Reads the address of the page that a program prints at its start.
pub fn address(program: &mut Child) -> String {
    let lines = BufReader::new(program.stdout.take().unwrap()).lines();
    let url = lines.map_while(Result::ok).find_map(|line| {
        let at = line.find("http://")?;
        Some(line[at..].to_owned())
    });
    url.unwrap()
}

/// Builds the command `myointent live` with these arguments.
pub fn live(arguments: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", "interrupt::child", "--ignored", "--nocapture"])
        .env(CHILD, arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    command
}

/// Sends Ctrl-C.
pub fn interrupt(process: &Child) {
    let sent = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

#[test]
fn ctrl_c_ends_the_program_in_order() {
    let mut child = live("--demo --listen 127.0.0.1:0").spawn().unwrap();
    let mut viewer = Viewer::connect(&address(&mut child));
    viewer.find("samples", |_| true);
    interrupt(&child);
    viewer.find("end", |_| true);
    while viewer.next().is_some() {}
    assert!(child.wait().unwrap().success());
}

/// Environment variable with the rest of the command line, set for the child process alone: somebody may run all
/// ignored tests.
const CHILD: &str = "MYOINTENT_TEST_LIVE";

#[test]
#[ignore = "other tests start it, as a process"]
fn child() {
    let Ok(arguments) = std::env::var(CHILD) else {
        return;
    };
    let line = ["myointent", "live"].into_iter();
    let line = line.chain(arguments.split(' '));
    let code = Cli::try_parse_from(line).unwrap().run();
    std::process::exit(i32::from(code != ExitCode::SUCCESS));
}
