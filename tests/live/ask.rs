//! Command to a board, and its answer.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser as _;
use myointent::board::{Board as Asked, BoardError};
use myointent::cli::Cli;
use rand::seq::IndexedRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serial2::SerialPort;
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::lock::LockTimes;
use shared::stream::smoother::Gate;
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::answer::{Accepted, Answer, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::gate::GateCommand;
use shared::uart_line::line::Line;
use shared::uart_line::lock::Locking;
use shared::units::SampleIndex;

use super::board::{Board, CUTS, terminal};
use super::scripted::{Scripted, identity};

fn image(answer: &Answer<'_>) -> Option<String> {
    match answer {
        Answer::Identity(identity) => Some(identity.image.to_owned()),
        _ => None,
    }
}

/// Asks a board that has just been found; returns true if the answer is the right one. Passes over answers to other
/// commands, as the program does: the line may have been pulled before they came.
fn ask_found(link: &Path, command: Command) -> Result<bool, BoardError> {
    let mut board = Asked::open(link)?;
    let is_right = board.ask(command, |answer| match (command, answer) {
        (Command::Identify, Answer::Identity(identity)) => Some(identity.image == "test"),
        (Command::Counters, Answer::Counts(counts)) => Some(counts.session.notifications == 1000),
        (Command::Align(command), Answer::Align(answered)) => {
            (Accepted::of(command) == Some(*answered)).then_some(true)
        }
        (Command::Raw(on), Answer::Raw(answered)) => Some(*answered == on),
        (Command::Gate(_), Answer::Gate(gate)) => Some(*gate == Gate::default()),
        _ => None,
    })?;
    if command == Command::Align(AlignCommand::Begin(Arm::Unknown)) {
        let waiting = board.wait(Duration::from_secs(10), |line| {
            matches!(line, Line::Alignment(_)).then_some(())
        })?;
        assert!(waiting.is_some(), "an alignment that nothing is said of");
    }
    Ok(is_right)
}

#[test]
fn a_line_pulled_at_100_random_moments_of_commands_gives_right_answers_or_says_that_it_was_lost() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let mut random = ChaCha8Rng::seed_from_u64(29);
    let commands = [
        Command::Identify,
        Command::Counters,
        Command::Raw(true),
        Command::Align(AlignCommand::Begin(Arm::Unknown)),
        Command::Align(AlignCommand::Set(Alignment::new(3, true))),
        Command::Gate(GateCommand::State),
        // This board's armband is built in: the command is refused.
        Command::Bind(BindCommand::Begin),
    ];
    // Some cuts fall in the command, some in its answer, some in the labels and samples after it.
    let dialogues = (0..CUTS).map(|_| random.random_range(1..300));
    let board = Board::pulled(&link, dialogues.collect());
    let (mut answered, mut lost) = (0, 0);
    while board.cuts() < CUTS {
        let command = *commands.choose(&mut random).unwrap();
        match ask_found(&link, command) {
            Ok(is_right) => {
                assert!(is_right, "{command:?}");
                answered += 1;
            }
            Err(BoardError::Refused(Refusal::BuiltIn)) => answered += 1,
            Err(error @ (BoardError::Lost { .. } | BoardError::Open { .. })) => {
                let said = error.to_string();
                assert!(said.contains("is it the board's port") || said.contains("was lost"));
                lost += 1;
            }
            Err(error) => panic!("{command:?}: {error}"),
        }
    }
    assert!(
        answered > 20 && lost > 20,
        "{answered} answered, {lost} lost"
    );
    // The half of a command that came before a cut is forgotten.
    for command in commands {
        let is_bind = matches!(command, Command::Bind(_));
        match ask_found(&link, command) {
            Ok(is_right) => assert!(is_right && !is_bind, "{command:?}"),
            Err(BoardError::Refused(Refusal::BuiltIn)) => assert!(is_bind, "{command:?}"),
            Err(error) => panic!("{command:?}: {error}"),
        }
    }
}

#[test]
fn a_damaged_line_is_asked_for_again() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let mut times = 0;
    let _board = Scripted::start(&link, move |_| {
        times += 1;
        let whole = identity(7).to_string();
        whole[..if times == 1 { 9 } else { whole.len() }].to_owned() + "\r\n"
    });
    let mut asked = Asked::open(&link).unwrap();
    assert_eq!(asked.ask(Command::Identify, image).unwrap(), "test");
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
    drop(board);
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
        drop(board);
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
