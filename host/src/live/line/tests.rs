use std::os::fd::AsRawFd as _;

use shared::installation::Progress;
use shared::uart_line::answer::{Answer, Identity, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, Command, CommandReader};
use web::SHIPPED;

use super::*;

/// Longest wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Terminal whose other end answers installations as `answer` does and names its model, until it is stopped.
struct Board {
    slave: SerialPort,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Vec<Command>>,
}

impl Board {
    fn start(answer: Answer<'static>) -> Self {
        let (mut master, slave) = SerialPort::pair().unwrap();
        master.set_read_timeout(WAIT).unwrap();
        master.set_write_timeout(WRITE).unwrap();
        let stop = Arc::<AtomicBool>::default();
        let stopped = stop.clone();
        let thread = std::thread::spawn(move || {
            let mut reader = CommandReader::new();
            let mut buffer = [0; 256];
            let mut heard = Vec::new();
            while !stopped.load(Ordering::Relaxed) {
                let length = master.read(&mut buffer).unwrap_or(0);
                for &byte in &buffer[..length] {
                    let Some(Ok(command)) = reader.push(byte) else {
                        continue;
                    };
                    let answer = match command {
                        Command::Identify => Answer::Identity(identity()),
                        Command::Raw(on) => Answer::Raw(on),
                        _ => answer,
                    };
                    master.write_all(answer.to_string().as_bytes()).unwrap();
                    heard.push(command);
                }
            }
            heard
        });
        Self {
            slave,
            stop,
            thread,
        }
    }

    fn line(&self) -> (Line, Receiver<Input>) {
        let path = std::fs::read_link(format!("/proc/self/fd/{}", self.slave.as_raw_fd()));
        let (inputs, received) = mpsc::channel();
        (Line::start(path.unwrap(), false, inputs).unwrap(), received)
    }

    /// Ends the board; returns the commands that it was sent.
    fn stop(self) -> Vec<Command> {
        std::thread::sleep(10 * WAIT);
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}

/// Identity of a board with the shipped model.
fn identity() -> Identity<'static> {
    let file = SHIPPED.to_vec();
    Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "test",
        model: Some(ModelFile::new(&file).unwrap().checksum()),
        armband: None,
        firmware: None,
        battery: None,
    }
}

/// States of an installation until the port is open again, and whether the model is in use.
fn installed(answer: Answer<'static>, wanted: &[u8]) -> (Vec<InstallationState>, bool) {
    let board = Board::start(answer);
    let (line, received) = board.line();
    let (mut states, mut is_used, mut opened) = (Vec::new(), false, 0);
    while opened < 2 {
        match received.recv_timeout(PATIENCE).unwrap() {
            Input::Opened => {
                opened += 1;
                if opened == 1 {
                    line.send(ToBoard::Install(wanted.to_vec()));
                }
            }
            Input::Event(Event::Installing(state)) => states.push(state),
            Input::Model(model) => is_used = model == wanted,
            _ => {}
        }
    }
    line.stop();
    board.stop();
    (states, is_used)
}

#[test]
fn what_was_asked_for_before_the_board_was_there_is_not_done_and_its_raw_stream_is_off_in_the_end()
{
    let board = Board::start(Answer::Install(Progress::Installed));
    let (inputs, received) = mpsc::channel();
    let link = tempfile::tempdir().unwrap();
    let path = link.path().join("board");
    let line = Line::start(path.clone(), false, inputs).unwrap();
    for early in [
        Command::Align(AlignCommand::Cancel),
        Command::Bind(BindCommand::Begin),
    ] {
        line.send(ToBoard::Line(early.to_string()));
    }
    let fd = board.slave.as_raw_fd();
    std::os::unix::fs::symlink(
        std::fs::read_link(format!("/proc/self/fd/{fd}")).unwrap(),
        path,
    )
    .unwrap();
    let opened = |input| matches!(input, Input::Opened);
    while !opened(received.recv_timeout(PATIENCE).unwrap()) {}
    line.send(ToBoard::Line(Command::Raw(true).to_string()));
    std::thread::sleep(10 * WAIT);
    line.stop();
    assert_eq!(board.stop(), [Command::Raw(true), Command::Raw(false)]);
}

#[test]
fn a_model_that_a_board_takes_is_the_one_whose_scores_are_shown() {
    let (states, is_used) = installed(Answer::Install(Progress::Installed), SHIPPED);
    assert_eq!((states.last().unwrap().state, is_used), ("done", true));
    // On the heap, which aligns it as a model requires.
    let file = SHIPPED.to_vec();
    let blocks = ModelFile::new(&file).unwrap().blocks();
    let whole = |state: &&InstallationState| (state.blocks, state.of) == (blocks, blocks);
    assert_eq!(states.iter().filter(whole).count(), 1, "{states:?}");
}

#[test]
fn a_model_that_a_board_refuses_and_a_file_that_none_can_run_are_said_so_and_the_board_is_read_again()
 {
    let refused = Answer::Refused(Refusal::Length);
    for (answer, file, why) in [
        (refused, SHIPPED, "the board refuses: "),
        (
            Answer::Install(Progress::Installed),
            &SHIPPED[..999],
            "no board can run this file",
        ),
    ] {
        let (states, is_used) = installed(answer, file);
        let last = states.last().unwrap();
        assert_eq!((last.state, is_used), ("failed", false), "{last:?}");
        assert!(last.text.starts_with(why), "{last:?}");
    }
}
