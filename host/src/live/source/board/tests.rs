use std::os::fd::AsRawFd as _;
use std::sync::{Arc, mpsc};

use serde_json::Value;
use shared::installation::Progress;
use shared::uart_line::answer::{Accepted, Answer, Identity, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, CommandReader};
use tokio::sync::broadcast::error::TryRecvError;

use super::*;
use crate::board::ModelFile;
use crate::live::hub::Hub;
use crate::live::source::Stop;
use web::SHIPPED;

/// Terminal whose other end answers every command, and installations as `answer` does, until it is stopped. The thread
/// returns the number of alignments and pairings.
fn board(answer: Answer<'static>, stop: &Stop) -> (SerialPort, std::thread::JoinHandle<usize>) {
    let (mut master, slave) = SerialPort::pair().unwrap();
    master.set_read_timeout(WAIT).unwrap();
    master.set_write_timeout(WRITE).unwrap();
    let stop = stop.clone();
    let thread = std::thread::spawn(move || {
        let mut reader = CommandReader::new();
        let mut buffer = [0; 256];
        let mut begun = 0;
        while !stop.requested() {
            let length = master.read(&mut buffer).unwrap_or(0);
            for command in buffer[..length]
                .iter()
                .filter_map(|&byte| reader.push(byte))
            {
                begun += usize::from(matches!(
                    command,
                    Ok(Command::Align(AlignCommand::Begin(_)) | Command::Bind(BindCommand::Begin))
                ));
                let accepted = match command {
                    Ok(Command::Align(command)) => Accepted::of(command),
                    _ => None,
                };
                let answer = match command {
                    Ok(Command::Install(_)) => answer,
                    Ok(Command::Raw(on)) => Answer::Raw(on),
                    Ok(Command::Identify) => Answer::Identity(identity()),
                    _ => accepted.map_or(Answer::Refused(Refusal::Busy), Answer::Align),
                };
                master.write_all(answer.to_string().as_bytes()).unwrap();
            }
        }
        begun
    });
    (slave, thread)
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

/// Messages to viewers from an installation request until the board is heard again and one more event.
fn installed(answer: Answer<'static>, wanted: &[u8]) -> Vec<Value> {
    let (hub, stop) = (Arc::new(Hub::new()), Stop::default());
    let (slave, thread) = board(answer, &stop);
    let path = std::fs::read_link(format!("/proc/self/fd/{}", slave.as_raw_fd())).unwrap();
    let mut following = hub.subscribe().following;
    let (requests, received) = mpsc::channel();
    let context = Context {
        hub,
        requests: received,
        stop: stop.clone(),
        imu: false,
    };
    let source = std::thread::Builder::new()
        .stack_size(crate::live::STACK)
        .spawn(move || BoardSource { path, model: None }.run(&context))
        .unwrap();
    let mut messages = Vec::new();
    let mut connections = 0;
    let end = Instant::now() + Duration::from_secs(60);
    while connections < 2 {
        assert!(Instant::now() < end, "{messages:?}");
        match following.try_recv() {
            Ok(message) => {
                let message: Value = serde_json::from_str(&message).unwrap();
                if message["type"] == "source" && message["connected"] == true {
                    connections += 1;
                    if connections == 1 {
                        requests
                            .send(SourceRequest::Install(wanted.to_vec()))
                            .unwrap();
                    }
                }
                messages.push(message);
            }
            Err(TryRecvError::Empty) => std::thread::sleep(WAIT),
            Err(error) => panic!("{error}"),
        }
    }
    stop.request();
    source.join().unwrap().unwrap();
    thread.join().unwrap();
    messages
}

#[test]
fn what_was_asked_for_before_the_board_was_there_is_not_done_once_it_is() {
    let (hub, stop) = (Arc::new(Hub::new()), Stop::default());
    let (slave, thread) = board(Answer::Install(Progress::Installed), &stop);
    let path = std::fs::read_link(format!("/proc/self/fd/{}", slave.as_raw_fd())).unwrap();
    let mut following = hub.subscribe().following;
    let (requests, received) = mpsc::channel();
    let context = Context {
        hub,
        requests: received,
        stop: stop.clone(),
        imu: false,
    };
    for early in [SourceRequest::Align, SourceRequest::Bind] {
        requests.send(early).unwrap();
    }
    let source = std::thread::Builder::new()
        .stack_size(crate::live::STACK)
        .spawn(move || BoardSource { path, model: None }.run(&context))
        .unwrap();
    let end = Instant::now() + Duration::from_secs(60);
    let is_heard = |message: &str| message.contains(r#""connected":true"#);
    while !following.try_recv().is_ok_and(|message| is_heard(&message)) {
        assert!(Instant::now() < end, "never heard");
        std::thread::yield_now();
    }
    // All commands of the beginning were sent by then.
    std::thread::sleep(10 * WAIT);
    stop.request();
    source.join().unwrap().unwrap();
    assert_eq!(thread.join().unwrap(), 0);
}

/// Last message of a kind.
fn last<'t>(messages: &'t [Value], kind: &str) -> Option<&'t Value> {
    messages.iter().rfind(|message| message["type"] == kind)
}

#[test]
fn a_model_that_a_board_takes_is_the_one_whose_scores_are_shown() {
    let messages = installed(Answer::Install(Progress::Installed), SHIPPED);
    let installing = last(&messages, "installing").unwrap();
    assert_eq!(installing["state"], "done", "{installing}");
    // On the heap, which aligns it as a model requires.
    let file = SHIPPED.to_vec();
    let blocks = ModelFile::new(&file).unwrap().blocks();
    let whole = |message: &&Value| message["blocks"] == blocks && message["of"] == blocks;
    assert_eq!(messages.iter().filter(whole).count(), 1, "{messages:?}");
    assert_eq!(
        last(&messages, "model").unwrap()["classes"],
        serde_json::json!(["relax", "open", "close"])
    );
}

#[test]
fn a_model_that_a_board_refuses_is_said_so_and_the_board_is_read_again() {
    let messages = installed(Answer::Refused(Refusal::Length), SHIPPED);
    let installing = last(&messages, "installing").unwrap();
    assert_eq!(installing["state"], "failed", "{installing}");
    let text = installing["text"].as_str().unwrap();
    assert!(text.starts_with("the board refuses: "), "{text}");
    assert_eq!(last(&messages, "model"), None);
}

#[test]
fn a_file_that_no_board_can_run_is_not_sent() {
    let messages = installed(Answer::Install(Progress::Installed), &SHIPPED[..999]);
    let installing = last(&messages, "installing").unwrap();
    assert_eq!(installing["state"], "failed", "{installing}");
    let text = installing["text"].as_str().unwrap();
    assert!(text.starts_with("no board can run this file"), "{text}");
}
