//! Line to a board, pulled at 100 random moments of each dialogue but the installation, which has its own test.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use myointent::board::{Board as Asked, BoardError};
use myointent::live::Source;
use rand::seq::IndexedRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::smoother::Gate;
use shared::uart_line::answer::{Accepted, Answer, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::uart_line::gate::GateCommand;
use shared::uart_line::line::Line;

use super::board::Board;
use super::record::{SHORT, assert_equal, record, recorded, wish};
use super::synthetic;
use super::viewer::Viewer;

const CUTS: usize = 100;

/// Asks a board that has just been found; returns true if the answer is the right one. Passes over answers to other
/// commands, as the program does: the line may have been pulled before they came.
fn ask(link: &Path, command: Command) -> Result<bool, BoardError> {
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
        match ask(&link, command) {
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
        match ask(&link, command) {
            Ok(is_right) => assert!(is_right && !is_bind, "{command:?}"),
            Err(BoardError::Refused(Refusal::BuiltIn)) => assert!(is_bind, "{command:?}"),
            Err(error) => panic!("{command:?}: {error}"),
        }
    }
}

#[test]
fn a_line_pulled_at_100_random_moments_of_a_session_loses_nothing_that_came() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let mut random = ChaCha8Rng::seed_from_u64(31);
    // Cuts fall between the first command of the dialogue and a second of samples after it.
    let dialogues = (0..CUTS).map(|_| f64::exp(random.random_range(0.0..9.0)) as usize + 1);
    let board = Board::pulled(&link, dialogues.collect());
    let live = record(folder.path(), Source::Port(link), SHORT, 1);
    let mut viewer = Viewer::connect(live.url());
    let source = synthetic(60).samples;
    viewer.find("samples", |_| true);
    wish(&mut viewer, "begin");
    // Numbers of the samples that a viewer was shown in the middle of a task.
    let mut seen = BTreeSet::new();
    let (mut lost, mut done) = (0, 0);
    let (mut in_task, mut held) = (false, false);
    // After the last cut the line stays whole and the session goes on.
    while board.cuts() < CUTS || done < 3 {
        let message = viewer.next().unwrap();
        match message["type"].as_str().unwrap() {
            "source" if message["connected"] == false => {
                let detail = message["detail"].as_str().unwrap();
                lost += usize::from(detail.contains("looking for it again"));
                in_task = false;
            }
            "session" => {
                in_task = message["phase"] == "cued";
                held = message["phase"] == "held";
                done = message["done"].as_u64().unwrap();
            }
            // The traces move again: a person presses the key until the session goes on.
            "samples" if held => wish(&mut viewer, "begin"),
            "samples" if in_task => {
                let first = message["first"].as_u64().unwrap() as usize;
                let shown = message["emg"].as_array().unwrap();
                for (number, shown) in (first..).zip(shown) {
                    let expected = serde_json::to_value(source[number % source.len()]).unwrap();
                    assert_eq!(*shown, expected, "sample {number}");
                    seen.insert(number);
                }
            }
            _ => {}
        }
    }
    assert!(lost > CUTS / 2, "{lost}: the page was not told");
    wish(&mut viewer, "finish");
    viewer.find("kept", |_| true);
    live.stop().unwrap();
    let files = recorded(folder.path());
    assert_equal(&files, &source);
    let kept: BTreeSet<usize> = files.iter().flat_map(|file| file.keys().copied()).collect();
    let missing = seen.difference(&kept).count();
    assert!(seen.len() > 2000, "{}", seen.len());
    assert_eq!(missing, 0, "of {} samples shown in a task", seen.len());
}
