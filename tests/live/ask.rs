//! One command to a board, and its answer.

use std::time::Duration;

use myointent::board::{Board as Asked, BoardError};
use serial2::SerialPort;
use shared::stream::alignment::Arm;
use shared::stream::smoother::Gate;
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::gate::GateCommand;
use shared::uart_line::line::Line;

use super::board::{Board, Damage, terminal};

fn image(answer: &Answer<'_>) -> Option<String> {
    match answer {
        Answer::Identity(identity) => Some(identity.image.to_owned()),
        _ => None,
    }
}

#[test]
fn each_command_is_answered_among_labels() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let _board = Board::start(&link, Damage::None);
    let mut asked = Asked::open(&link).unwrap();
    assert_eq!(asked.ask(Command::Identify, image).unwrap(), "test");
    let raw = Command::Raw(true);
    let is_on = |answer: &Answer<'_>| (*answer == Answer::Raw(true)).then_some(());
    asked.ask(raw, is_on).unwrap();
    let notifications = |answer: &Answer<'_>| match answer {
        Answer::Counts(counts) => Some(counts.session.notifications),
        _ => None,
    };
    assert_eq!(asked.ask(Command::Counters, notifications).unwrap(), 1000);
    let state = Command::Gate(GateCommand::State);
    let gate = |answer: &Answer<'_>| match answer {
        Answer::Gate(gate) => Some(*gate),
        _ => None,
    };
    assert_eq!(asked.ask(state, gate).unwrap(), Gate::default());
    let begin = Command::Align(AlignCommand::Begin(Arm::Unknown));
    let accepted = |answer: &Answer<'_>| matches!(answer, Answer::Align(_)).then_some(());
    asked.ask(begin, accepted).unwrap();
    let news = asked.wait(Duration::from_secs(10), |line| match line {
        Line::Alignment(report) => Some(report.state.name()),
        _ => None,
    });
    assert_eq!(news.unwrap(), Some("waiting"));
}

#[test]
fn a_refusal_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let _board = Board::start(&link, Damage::None);
    let mut asked = Asked::open(&link).unwrap();
    let refused = asked.ask(Command::Bind(BindCommand::Begin), |_| Some(()));
    assert!(
        matches!(refused, Err(BoardError::Refused(Refusal::BuiltIn))),
        "{refused:?}"
    );
}

#[test]
fn a_damaged_line_is_asked_for_again() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let _board = Board::start(&link, Damage::CutsAndGarbage(3));
    let mut asked = Asked::open(&link).unwrap();
    for _ in 0..30 {
        assert_eq!(asked.ask(Command::Identify, image).unwrap(), "test");
    }
}

#[test]
fn a_port_without_a_board_is_silent_and_one_that_is_missing_cannot_be_opened() {
    let (_master, slave) = SerialPort::pair().unwrap();
    let mut asked = Asked::open(&terminal(&slave)).unwrap();
    let silent = asked.ask(Command::Identify, image);
    assert!(
        matches!(silent, Err(BoardError::Silent { .. })),
        "{silent:?}"
    );
    let missing = Asked::open("/no/such/port".as_ref());
    assert!(matches!(missing, Err(BoardError::Open { .. })));
}
