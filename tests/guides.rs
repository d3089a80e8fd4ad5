//! Commands of the guides, in the order of the page. Those that need nothing are run; of all others the program, the
//! subcommand and the options are checked.
//!
//! A block of `sh` is run. A block that says what it needs (```` ```sh needs: a board ````) is parsed, and SKIPPED with
//! that reason.

#[path = "small.rs"]
mod small;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser as _;
use clap::error::ErrorKind;
use myointent::cli::Cli;
use small::{BEGIN, process, shrunk};

struct Block {
    /// Requirement of the block; `None` if it is run.
    needs: Option<String>,
    /// Commands of the block without remarks.
    lines: Vec<String>,
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in text.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => {
                let (language, rest) = info.split_once(' ').unwrap_or((info, ""));
                assert_eq!(language, "sh", "a block of what?");
                let needs = (!rest.is_empty()).then(|| {
                    let reason = rest
                        .strip_prefix("needs: ")
                        .expect("`sh`, or `sh needs: …`");
                    reason.to_owned()
                });
                open = Some(Block {
                    needs,
                    lines: Vec::new(),
                });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(block), None) => {
                let command = line.split(" #").next().unwrap_or_default().trim();
                if !command.is_empty() {
                    block.lines.push(command.to_owned());
                }
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block without an end");
    blocks
}

/// Splits a command into words, and the file that its output goes to. The guides need no quotes.
fn words(line: &str) -> (Vec<String>, Option<String>) {
    assert!(
        !line.contains(['"', '\'', '\\', '|', ';', '&', '$', '*']),
        "{line}: more shell than this test knows"
    );
    let (command, out) = match line.split_once(" > ") {
        Some((command, file)) => (command, Some(file.trim().to_owned())),
        None => (line, None),
    };
    (command.split_whitespace().map(str::to_owned).collect(), out)
}

/// Checks program, subcommand and options of a command that is not run.
fn parse(words: &[String]) -> Result<(), String> {
    let refused = |error: clap::Error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => None,
        _ => Some(error.to_string()),
    };
    let program = Path::new(&words[0]).file_name().unwrap().to_str().unwrap();
    let error = match program {
        "myointent" => Cli::try_parse_from(words).err().and_then(refused),
        "myointent-research" => {
            let parsed = myointent_research::cli::Cli::try_parse_from(words);
            parsed.err().and_then(refused)
        }
        "cargo" if words[1] == "xtask" => {
            let parsed = xtask::steps::Arguments::try_parse_from(&words[1..]);
            parsed.err().and_then(refused)
        }
        "cargo" => return cargo(&words[1..]),
        // Another project's program.
        "probe-rs" => None,
        other => Some(format!("{other}: which program is that?")),
    };
    error.map_or(Ok(()), Err)
}

/// Checks that the repository has the packages, tests and features that are named.
fn cargo(words: &[String]) -> Result<(), String> {
    let read = |path: &str| fs::read_to_string(repository().join(path)).unwrap();
    let (step, rest) = words.split_first().ok_or("cargo: no command")?;
    match step.as_str() {
        "board" => Ok(()),
        "run" | "test" | "build" => {
            for pair in rest.windows(2) {
                let found = match pair[0].as_str() {
                    "-p" => ["host", "firmware"]
                        .iter()
                        .any(|folder| read(&format!("{folder}/Cargo.toml")).contains(&pair[1])),
                    "--test" => {
                        read("tests/Cargo.toml").contains(&format!("name = \"{}\"", pair[1]))
                    }
                    "--features" => read("host/Cargo.toml").contains(&format!("\n{} = ", pair[1])),
                    _ => true,
                };
                if !found {
                    return Err(format!("no {} {}", pair[0], pair[1]));
                }
            }
            Ok(())
        }
        other => Err(format!("cargo {other}: not known to this test")),
    }
}

fn run(folder: &Path, words: &[String], out: Option<&str>) {
    let output = process(&words[1..].join(" "))
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {error}", words.join(" "));
    if let Some(out) = out {
        let text = String::from_utf8(output.stdout).unwrap();
        let (_, text) = text.split_once(&format!("{BEGIN}\n")).unwrap();
        // A preset of a guide trains for minutes: its size does not matter here.
        let text = if out.ends_with(".toml") {
            &shrunk(text)
        } else {
            text
        };
        fs::write(folder.join(out), text).unwrap();
    }
}

/// Makes a folder with the repository's models and nothing else.
fn workplace(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("guides")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("models")).unwrap();
    for model in ["three-class.intent", "five-class.intent"] {
        let from = repository().join("models").join(model);
        fs::copy(from, folder.join("models").join(model)).unwrap();
    }
    folder
}

/// Runs a guide from top to bottom.
fn guide(name: &str) {
    let path = repository().join("docs/guides").join(format!("{name}.md"));
    let text = fs::read_to_string(path).unwrap();
    let folder = workplace(name);
    let blocks = blocks(&text);
    assert!(!blocks.is_empty(), "{name} has no commands");
    for block in blocks {
        for line in &block.lines {
            let (words, out) = words(line);
            if let Err(error) = parse(&words) {
                panic!("docs/guides/{name}.md: {line}\n{error}");
            }
            if block.needs.is_none() {
                assert_eq!(words[0], "myointent", "{line}: say what it needs");
                run(&folder, &words, out.as_deref());
            }
        }
        if let Some(needs) = block.needs {
            let count = block.lines.len();
            println!(
                "SKIPPED docs/guides/{name}.md: {count} commands parsed and not run, which need {needs}"
            );
        }
    }
}

macro_rules! guides {
    ($($test:ident: $name:literal),* $(,)?) => {
        $(
            #[test]
            fn $test() {
                guide($name);
            }
        )*

        /// Names of the guides that a test runs.
        const RUN: &[&str] = &[$($name),*];
    };
}

guides! {
    flash: "flash",
    wire: "wire",
    train: "train",
    evaluate: "evaluate",
    record: "record",
    personalise: "personalise",
    port: "port",
    data_set: "data-set",
}

#[test]
fn every_guide_is_run() {
    let folder = fs::read_dir(repository().join("docs/guides")).unwrap();
    let pages = folder.map(|entry| {
        let path = entry.unwrap().path();
        path.file_stem().unwrap().to_str().unwrap().to_owned()
    });
    let run: BTreeSet<String> = RUN.iter().map(|&name| name.to_owned()).collect();
    assert_eq!(pages.collect::<BTreeSet<_>>(), run);
}

#[test]
fn a_misspelt_option_is_found() {
    let words = |line: &str| words(line).0;
    parse(&words(
        "myointent train --preset cpu --data DIR --run runs/mine",
    ))
    .unwrap();
    for line in [
        "myointent train --presets cpu",
        "myointent board --port /dev/ttyACM0 identfy",
        "myointent-research cross-validate --peset cpu",
        "cargo xtask image",
        "cargo test --test scenarios",
        "mointent info FILE",
    ] {
        assert!(parse(&words(line)).is_err(), "{line}");
    }
}
