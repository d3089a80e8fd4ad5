use std::os::fd::AsRawFd as _;
use std::os::unix::fs::symlink;

use shared::uart_line::command::{AlignCommand, BindCommand, Command};

use super::*;

/// Longest wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn what_was_asked_for_before_the_board_was_there_is_not_done_and_its_raw_stream_is_off_in_the_end()
{
    let (mut board, slave) = SerialPort::pair().unwrap();
    board.set_read_timeout(PATIENCE).unwrap();
    let (inputs, received) = mpsc::channel();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board");
    let line = Line::start(path.clone(), false, inputs).unwrap();
    for early in [
        Command::Align(AlignCommand::Cancel),
        Command::Bind(BindCommand::Begin),
    ] {
        line.send(early.to_string());
    }
    let terminal = std::fs::read_link(format!("/proc/self/fd/{}", slave.as_raw_fd()));
    symlink(terminal.unwrap(), path).unwrap();
    let opened = |input| matches!(input, Input::Port(Ok(())));
    while !opened(received.recv_timeout(PATIENCE).unwrap()) {}
    let sent = [true, false].map(|on| Command::Raw(on).to_string());
    line.send(sent[0].clone());
    let mut heard = vec![0; sent[0].len()];
    board.read_exact(&mut heard).unwrap();
    line.stop();
    let mut last = vec![0; sent[1].len()];
    board.read_exact(&mut last).unwrap();
    assert_eq!([heard, last], sent.map(String::into_bytes));
}
