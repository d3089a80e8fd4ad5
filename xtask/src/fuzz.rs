//! Coverage-guided fuzzing: builds the program of tests/fuzz and runs its targets.
//!
//! Stable Rust suffices: the coverage counters are LLVM's, and any C++ compiler compiles libFuzzer from the sources in
//! its crate. No sanitizer: there is no unsafe code to watch.

mod corpus;
mod program;

use std::{fmt, fs, path::Path, process::Command, time::Instant};

use anyhow::{Context as _, Result, ensure};
use rayon::prelude::*;

use self::program::{Target, folder};

/// Seconds of a target where nothing else is said.
const SECONDS: u32 = 10;
/// Seconds that one input may take.
const TIMEOUT: &str = "-timeout=10";
/// KiB of address space: an allocation by a number in the input fails instead of being left unused.
const MEMORY_KIB: u32 = 2 << 20;

/// Options of the fuzzing: its targets, and its limits.
#[derive(clap::Args)]
pub struct Arguments {
    /// Seconds of each target at most; 10 without `--runs`.
    #[arg(long, value_name = "N")]
    seconds: Option<u32>,
    /// Executions of each target at most.
    #[arg(long, value_name = "N")]
    runs: Option<u64>,
    /// A target to run, instead of all; may be given again.
    #[arg(long, value_name = "NAME")]
    target: Vec<String>,
    /// Writes what runs have learned to tests/fuzz/corpus, an input for each branch, and runs no target.
    #[arg(long)]
    keep: bool,
}

/// Runs the targets, one on each core, and prints a table: executions, executions a second, branches reached, result.
pub fn run(arguments: &Arguments) -> Result<()> {
    let program = program::build()?;
    let known = program::targets(&program)?;
    let names: Vec<&str> = known.iter().map(|target| target.name.as_str()).collect();
    for name in &arguments.target {
        let all = names.join(", ");
        ensure!(
            names.contains(&name.as_str()),
            "no target {name}; there are {all}"
        );
    }
    let wanted =
        |target: &&Target| arguments.target.is_empty() || arguments.target.contains(&target.name);
    if arguments.keep {
        for target in known.iter().filter(wanted) {
            let (inputs, bytes) = corpus::keep(&program, target)?;
            println!("{:<16} {inputs:>5} inputs, {bytes:>7} bytes", target.name);
        }
        return Ok(());
    }
    println!("target             executions  a second  branches  inputs  result");
    let targets: Vec<_> = known.iter().filter(wanted).collect();
    // A target is a process of one thread: one on each core.
    let fuzzed = targets.par_iter().with_max_len(1).map(|target| {
        let outcome = fuzz(&program, target, arguments)?;
        let name = &target.name;
        println!("{name:<16} {outcome}");
        Ok(outcome.finding.map(|finding| format!("{name}: {finding}")))
    });
    // Each is run to its end, whatever becomes of another.
    let outcomes: Vec<Result<Option<String>>> = fuzzed.collect();
    let findings: Vec<&str> = outcomes
        .iter()
        .flatten()
        .flatten()
        .map(String::as_str)
        .collect();
    ensure!(findings.is_empty(), "{}", findings.join("\n"));
    outcomes
        .into_iter()
        .try_for_each(|outcome| outcome.map(drop))
}

struct FuzzOutcome {
    executions: u64,
    branches: u64,
    inputs: u64,
    seconds: f64,
    finding: Option<String>,
}

impl fmt::Display for FuzzOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            executions,
            branches,
            inputs,
            ..
        } = self;
        let rate = *executions as f64 / self.seconds.max(0.001);
        let result = if self.finding.is_some() {
            "FOUND"
        } else {
            "ok"
        };
        write!(
            f,
            "{executions:>12}  {rate:>8.0}  {branches:>8}  {inputs:>6}  {result}"
        )
    }
}

fn fuzz(program: &Path, target: &Target, arguments: &Arguments) -> Result<FuzzOutcome> {
    let Target { name, longest } = target;
    let learned = corpus::learned(name)?;
    let kept = corpus::kept(name)?;
    let findings = folder().join("findings").join(name);
    // Of files that a target writes.
    let temporary = folder().join("temporary").join(name);
    for folder in [&findings, &temporary] {
        fs::create_dir_all(folder)?;
    }
    let seconds = match (arguments.seconds, arguments.runs) {
        (Some(seconds), _) => seconds,
        (None, Some(_)) => 0,
        (None, None) => SECONDS,
    };
    // No limit: 0 seconds, or -1 runs.
    let limits = [
        format!("-max_total_time={seconds}"),
        arguments
            .runs
            .map_or_else(|| "-runs=-1".to_owned(), |runs| format!("-runs={runs}")),
    ];
    let start = Instant::now();
    let output = Command::new("sh")
        .arg("-c")
        .arg(format!("ulimit -v {MEMORY_KIB} && exec \"$0\" \"$@\""))
        .arg(program)
        .arg(format!("-max_len={longest}"))
        .args([TIMEOUT, "-print_final_stats=1", "-verbosity=1"])
        .args(limits)
        .arg(format!("-artifact_prefix={}/", findings.display()))
        .args([learned, corpus::seeds(name), kept])
        .env("MYOINTENT_FUZZ_TARGET", name)
        .env("TMPDIR", &temporary)
        .env("RUST_BACKTRACE", "1")
        .output()
        .context("sh cannot be run")?;
    let seconds = start.elapsed().as_secs_f64();
    fs::remove_dir_all(&temporary)?;
    let log = String::from_utf8_lossy(&output.stderr);
    let file = findings.join("log");
    fs::write(&file, log.as_bytes())?;
    let finding = (!output.status.success()).then(|| reason(&log, &file));
    Ok(FuzzOutcome {
        executions: last(&log, "stat::number_of_executed_units: "),
        branches: last(&log, " cov: "),
        inputs: last(&log, " corp: "),
        seconds,
        finding,
    })
}

/// The number behind the last place in libFuzzer's log that has these words; 0 without one.
fn last(log: &str, words: &str) -> u64 {
    let rest = log.rsplit_once(words).map_or("", |(_, rest)| rest);
    let digits = rest.trim_start().split(|c: char| !c.is_ascii_digit());
    let number = digits.into_iter().next().map(str::parse);
    number.and_then(Result::ok).unwrap_or_default()
}

/// Describes a failure by its log.
fn reason(log: &str, file: &Path) -> String {
    let lines: Vec<&str> = log.lines().collect();
    let panic = lines.iter().position(|line| line.contains("panicked at"));
    let place = panic.map(|at| lines[at..lines.len().min(at + 4)].join("\n  "));
    let error = lines.iter().find(|line| line.contains("ERROR:"));
    let what = place.or_else(|| error.map(|line| (*line).to_owned()));
    let input = lines
        .iter()
        .find_map(|line| line.split("written to ").nth(1));
    format!(
        "{}\n  input: {}\n  log: {}",
        what.unwrap_or_else(|| "ended without a word".to_owned()),
        input.unwrap_or("none"),
        file.display()
    )
}

#[cfg(test)]
mod tests {
    use super::program::sources;
    use super::*;

    #[test]
    fn a_finding_names_the_panic_and_the_input() {
        let log = "#7\tNEW cov: 1 ft: 1 corp: 1/1b\nthread '<unnamed>' panicked at src/x.rs:1:2:\nno\n\
                   artifact_prefix='a/'; Test unit written to a/crash-1\n";
        let reason = reason(log, Path::new("log"));
        assert!(
            reason.contains("src/x.rs:1:2") && reason.contains("a/crash-1"),
            "{reason}"
        );
    }

    #[test]
    fn numbers_are_those_of_the_last_line_that_has_them() {
        let log = "INFO: Seed: 1\n#2\tINITED cov: 14 ft: 15 corp: 1/1b exec/s: 0 rss: 28Mb\n\
                   #4798095\tDONE   cov: 44 ft: 116 corp: 50/14998b lim: 4096 exec/s: 533121 rss: 28Mb\n\
                   stat::number_of_executed_units: 4798096\n";
        let words = ["stat::number_of_executed_units: ", " cov: ", " corp: "];
        assert_eq!(words.map(|words| last(log, words)), [4_798_096, 44, 50]);
        assert_eq!(last("nothing\n", " cov: "), 0);
    }

    #[test]
    fn every_target_has_seeds_in_the_repository() {
        let registered = fs::read_to_string(sources().join("src/targets/mod.rs")).unwrap();
        let names = registered.split("target(\"").skip(1);
        let names: Vec<_> = names.filter_map(|rest| rest.split('"').next()).collect();
        assert!(names.len() > 10, "{names:?}");
        for name in names {
            let seeds = fs::read_dir(sources().join("corpus").join(name));
            assert!(
                seeds.is_ok_and(|mut seeds| seeds.next().is_some()),
                "{name}"
            );
        }
    }
}
