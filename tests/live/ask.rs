//! Command to a board, and its answer.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser as _;
use myointent::board::{Board as Asked, BoardError};
use myointent::cli::Cli;
use serial2::SerialPort;
use shared::hid::{self, HidCommand};
use shared::installation::{Block, InstallationProgress, Transfer};
use shared::myo::Following;
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::lock::LockTimes;
use shared::stream::smoother::Gate;
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::answer::{Accepted, Answer, Counts, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::gate::GateCommand;
use shared::uart_line::line::Line;
use shared::uart_line::lock::{LockCommand, Locking};
use shared::units::SampleIndex;

use super::board::{Board, Damage, terminal};
use super::scripted::{Scripted, armband, binding, identity};

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

const fn gate(entry: i16) -> Gate {
    Gate {
        entry: Some(entry),
        other: None,
        reaction: None,
    }
}

const fn locking(locked: bool) -> Locking {
    Locking {
        times: LockTimes::USUAL,
        locked,
    }
}

/// Returns commands, each with answers to other commands that come before its own answer, and its own answer.
#[rustfmt::skip]
fn late() -> Vec<(Command, Vec<Answer<'static>>, Answer<'static>)> {
    use Answer::{Alignment as Placed, Gate as Of, Raw, Refused};
    use Command::{Align, Bind, Gate as Set, Hid, Install, Lock};
    let [mine, other] = ["FA:12:34:56:78:9A", "FA:12:34:56:78:9B"].map(armband);
    let bound = |address| binding(Following::Bound(address));
    let [nobody, pairing, strongest] = [Following::Nobody, Following::Pairing, Following::Strongest].map(binding);
    // The line does not say which alignment is set.
    let turned = Alignment::new(3, true);
    let [begin, cancel, set] = [AlignCommand::Begin(Arm::Unknown), AlignCommand::Cancel, AlignCommand::Set(turned)].map(Align);
    let [begun, cancelled, was_set] = [Accepted::Begin, Accepted::Cancel, Accepted::Set].map(Answer::Align);
    let [no_model, no_stream, built_in, length, block, not_begun, model, flash] = [
        Refusal::NoModel, Refusal::NoStream, Refusal::BuiltIn, Refusal::Length,
        Refusal::Block, Refusal::NotBegun, Refusal::Model, Refusal::Flash,
    ].map(Refused);
    let refusals = vec![no_model, no_stream, built_in, length, block, not_begun, model, flash];
    let transfer = Transfer { length: 84_729, checksum: 7 };
    let next = |block| Answer::Install(InstallationProgress::Next(block));
    let counts = Answer::Counts(Counts::default());
    let lock = |locked| Answer::Lock(Some(locking(locked)));
    vec![
        (Command::Identify, refusals.clone(), identity(7)),
        (Command::Counters, refusals.clone(), counts),
        (Command::Raw(true), refusals, Raw(true)),
        (Command::Identify, vec![counts, next(1), nobody], identity(7)),
        (Command::Counters, vec![identity(7), Of(gate(1))], counts),
        (Command::Raw(true), vec![Raw(false)], Raw(true)),
        (Command::Raw(false), vec![Raw(true)], Raw(false)),
        (begin, vec![cancelled, was_set, Placed(turned)], begun),
        (begin, vec![built_in, flash, length], begun),
        (cancel, vec![begun, was_set], cancelled),
        (cancel, vec![no_stream, built_in], cancelled),
        (set, vec![begun, cancelled, Placed(turned)], was_set),
        (Align(AlignCommand::State), vec![begun, was_set, no_stream], Placed(turned)),
        (Bind(BindCommand::Begin), vec![bound(mine), nobody], pairing),
        (Bind(BindCommand::Set(mine)), vec![nobody, pairing, bound(other)], bound(mine)),
        (Bind(BindCommand::Forget), vec![pairing, bound(mine)], nobody),
        (Bind(BindCommand::Forget), vec![bound(mine)], strongest),
        (Bind(BindCommand::State), vec![counts, no_stream], bound(mine)),
        (Set(GateCommand::Set(gate(150))), vec![Of(Gate::default()), Of(gate(50))], Of(gate(150))),
        (Set(GateCommand::Set(gate(150))), vec![no_stream, built_in, flash], Of(gate(150))),
        (Set(GateCommand::State), vec![nobody, identity(7)], Of(gate(1))),
        (Lock(LockCommand::Set(LockTimes::USUAL)), vec![Answer::Lock(None), counts], lock(true)),
        (Lock(LockCommand::Hold { is_locked: false }), vec![lock(true)], lock(false)),
        (
            Hid(HidCommand::Switch(true)), vec![Answer::Hid(hid::Settings::OFF), counts],
            Answer::Hid(hid::Settings::OFF.after(HidCommand::Switch(true))),
        ),
        (Install(transfer), vec![counts, nobody], next(0)),
        (Install(transfer), vec![not_begun, no_stream, model], next(0)),
        (Command::Block(0, Block::ERASED), vec![length, Raw(true)], next(64)),
    ]
}

#[test]
fn an_answer_to_another_request_is_passed_over_whatever_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    for (command, others, own) in late() {
        let lines: String = others.iter().chain([&own]).map(Answer::to_string).collect();
        let board = Scripted::start(&link, move |_| lines.clone());
        let mut asked = Asked::open(&link).unwrap();
        let answer = asked.ask(command, |answer| Some(answer.to_string()));
        assert_eq!(answer.unwrap(), own.to_string(), "{command}");
        board.end();
    }
}

#[test]
fn a_board_that_answers_something_else_alone_is_not_called_silent() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let _board = Scripted::start(&link, |_| Answer::Gate(gate(50)).to_string());
    let mut asked = Asked::open(&link).unwrap();
    let set = Command::Gate(GateCommand::Set(gate(150)));
    let error = asked
        .ask(set, |answer| Some(answer.to_string()))
        .unwrap_err();
    let text = error.to_string();
    for part in ["GATE,set,150,-,-", "OK,GATE,50,-,-", "other program"] {
        assert!(text.contains(part), "{text}");
    }
}

/// Runs `myointent board --port LINK ...`; returns true if it succeeds.
fn run(link: &Path, arguments: &[&str]) -> bool {
    let line = ["myointent", "board", "--port", link.to_str().unwrap()];
    let line = line.iter().chain(arguments);
    Cli::try_parse_from(line).unwrap().run() == ExitCode::SUCCESS
}

#[test]
fn a_lock_is_set_by_times_that_a_lock_can_have() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Scripted::start(&link, |_| Answer::Lock(Some(locking(true))).to_string());
    assert!(run(&link, &["lock", "on"]));
    assert!(run(&link, &["lock", "lock"]));
    assert!(!run(&link, &["lock", "on", "--sign", "0.4"]));
    // The board says another time than was asked for.
    assert!(!run(&link, &["lock", "on", "--sign", "3"]));
    board.end();
}

#[test]
fn an_alignment_counts_as_set_once_the_board_says_that_it_is_in_force() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let set = ["align", "set", "3", "--mirrored"];
    let reset = ["align", "reset"];
    for (in_force, asked, expected) in [
        (Alignment::new(3, true), &set[..], true),
        (Alignment::NONE, &set, false),
        (Alignment::NONE, &reset, true),
        (Alignment::new(3, true), &reset, false),
    ] {
        let board = Scripted::start(&link, move |command| match command {
            Command::Align(AlignCommand::State) => Answer::Alignment(in_force).to_string(),
            // Answer to a `set` that another program has sent.
            _ => Answer::Align(Accepted::Set).to_string(),
        });
        let done = run(&link, asked);
        assert_eq!(done, expected, "{asked:?} {in_force:?}");
        board.end();
    }
}

#[test]
fn an_alignment_that_ends_before_it_is_answered_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let unavailable = AlignmentReport {
        sequence: 7,
        emitted: SampleIndex(100),
        state: AlignmentState::Unavailable,
        alignment: Alignment::NONE,
        gestures: 0,
        quality: None,
    };
    // Lines that follow from a command come before its answer.
    let lines = unavailable.to_string() + &Answer::Align(Accepted::Cancel).to_string();
    let begun = Answer::Align(Accepted::Begin).to_string();
    let _board = Scripted::start(&link, move |_| lines.clone() + &begun);
    let began = Instant::now();
    assert!(!run(&link, &["align", "begin"]));
    assert!(began.elapsed() < Duration::from_secs(10), "{began:?}");
}
