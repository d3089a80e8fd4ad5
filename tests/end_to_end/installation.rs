//! Installation with `myointent board install` on the simulated board, whose flash is in files that a reset keeps.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::ensure;
use clap::Parser as _;
use myointent::cli::Cli;
use myointent_tests::bench::{Bridge, Run};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Line that the board writes while an installation is not complete.
const INCOMPLETE: &str = "# no model: an installation is not complete; `myointent board --port PATH install FILE` with the same \
     file goes on with it";
/// Number of resets in the middle of an installation.
const RESETS: usize = 8;

fn other() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent")
}

fn checksum() -> anyhow::Result<String> {
    let file = std::fs::read(other())?;
    let checksum = file
        .last_chunk()
        .map_or(0, |bytes| u32::from_le_bytes(*bytes));
    Ok(format!("{checksum:08x}"))
}

/// Runs the command as a person gives it.
fn install(port: &Path) -> ExitCode {
    let (port, file) = (port.display().to_string(), other().display().to_string());
    let line = ["myointent", "board", "--port", &port, "install", &file];
    Cli::try_parse_from(line).expect("a command").run()
}

/// Counts the answers in which the board took a block, or said where the installation goes on.
fn answered(run: &Run) -> usize {
    let answers = run.answers();
    answers
        .iter()
        .filter(|answer| answer.starts_with("OK,INSTALL,"))
        .count()
}

#[test]
fn an_installation_goes_on_after_resets_at_random_moments() -> anyhow::Result<()> {
    let mut run = Run::alone()?;
    run.wait_for("the start", |run| !run.comments().is_empty())?;
    let bridge = Bridge::start(run)?;
    let port = bridge.port().to_owned();
    // The installation goes on by itself, as with any board that is lost.
    let command = std::thread::spawn(move || install(&port));
    let mut random = ChaCha8Rng::seed_from_u64(17);
    for number in 1..=RESETS {
        // The resets fall by the board's answers, which the machine's load moves little.
        let blocks = answered(&bridge.run()) + random.random_range(3..150);
        while answered(&bridge.run()) < blocks {
            ensure!(!command.is_finished(), "it ended: {}", bridge.run().tails());
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        bridge.run().reset()?;
        let mut run = bridge.run();
        run.wait_for("the start", |run| {
            let comments = run.comments();
            let starts = comments
                .iter()
                .filter(|comment| comment.starts_with("# myointent "));
            // The line after the program's name says why it is safe.
            starts.count() == number + 1
                && !comments[comments.len() - 1].starts_with("# myointent ")
        })?;
        let comments = run.comments();
        let start = comments
            .iter()
            .rposition(|comment| comment.starts_with("# myointent "));
        let said = &comments[start.unwrap_or(0)..];
        ensure!(
            said[0].contains(", model refused,") && said[1] == INCOMPLETE,
            "{said:#?}"
        );
        ensure!(run.pins().iter().all(|pins| !pins.valid), "{}", run.tails());
    }
    let ended = command.join().expect("a command does not panic");
    ensure!(ended == ExitCode::SUCCESS, "{}", bridge.run().tails());
    let mut run = bridge.run();
    run.reset()?;
    let started = format!(", model {}, started by power or reset", checksum()?);
    run.wait_for("a start with the new model", |run| {
        run.comments()
            .iter()
            .any(|comment| comment.ends_with(&started))
    })?;
    run.check()
}
