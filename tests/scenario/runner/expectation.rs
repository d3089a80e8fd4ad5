//! Expectations of a scenario, and their check.

mod pins;

use anyhow::{Context as _, bail, ensure};
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::output::BoardOutput;
use serde::Deserialize;
use shared::stream::smoother::{Gate, Reaction};
use shared::uart_line::ReportKind;
use shared::units::{Millis, Sample};

/// Expected result of a scenario; only the given fields are checked.
#[derive(Deserialize, Clone, Default)]
#[serde(deny_unknown_fields, default)]
pub struct Expectation {
    /// Inputs of the pipeline whose lines equal the board's numbered lines.
    pipeline: Option<Vec<Reached>>,
    /// Causes of the safe state, from `$STATE` line to `$STATE` line, `valid` where the state was not safe; equal
    /// neighbours count once.
    states: Option<Vec<String>>,
    /// Causes of each start of the program.
    starts: Option<Vec<String>>,
    /// Comments with their numbers.
    comments: Vec<Comment>,
    /// Bodies of the answers; one that ends in `…` may go on.
    answers: Option<Vec<String>>,
    /// States of alignments.
    alignments: Option<Vec<String>>,
    /// Number of times that `valid` rises.
    rises: Option<usize>,
    /// Counters of the last report.
    counters: Option<Counters>,
    /// Milliseconds from the fault to safe pins, at most.
    safe_within_ms: Option<u64>,
    /// Smallest number of lines with raw samples, which must be those sent, from some sample on, without a hole.
    raw_without_holes: Option<usize>,
    /// Counts in the last answer to `COUNTERS`: name, least and most.
    counts: Vec<Count>,
    /// Mean and longest time from the newest sample that a label depends on to the pins, in tenths of a millisecond,
    /// over all labels that change the pins. Virtual time repeats, so both are exact.
    delay_tenths_ms: Option<(u64, u64)>,
    /// True if the board may restart.
    may_restart: bool,
    /// True if the region must hold the file that was installed.
    pub installed: bool,
}

/// Input of the pipeline.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum Reached {
    /// Notifications from the first to before the second number.
    Sent(usize, usize),
    /// Number of lost notifications.
    Lost(usize),
    /// End of the connection.
    Disconnected,
    /// Milliseconds of silence.
    SilenceMs(u32),
    /// Change of the operating point: margins in hundredths.
    Gate {
        entry: Option<i16>,
        other: Option<i16>,
        reaction: Option<Reaction>,
    },
    /// Strength on lines, or no longer.
    Strength(bool),
}

/// Comment line, and how many the board must write.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
struct Comment {
    /// Text that the line contains.
    text: String,
    /// Exact number of such lines.
    times: Option<usize>,
    /// Smallest number of such lines.
    #[serde(default)]
    least: usize,
}

/// Counters of the link.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(deny_unknown_fields)]
struct Counters {
    lost: u32,
    bridged: u32,
    resets: u32,
}

/// Bounds of a count in an answer to `COUNTERS`.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
struct Count {
    /// Name, as in README.md.
    name: String,
    #[serde(default)]
    least: u32,
    #[serde(default = "any")]
    most: u32,
}

const fn any() -> u32 {
    u32::MAX
}

/// Names of the counts in an answer to `COUNTERS`, in its order.
const COUNTS: [&str; 16] = [
    "connections",
    "failed-connects",
    "timeouts",
    "stalls",
    "failed-set-ups",
    "refused",
    "notifications",
    "lost",
    "given-up",
    "duplicates",
    "reordered",
    "malformed",
    "foreign",
    "packets-dropped",
    "lines-dropped",
    "emg-dropped",
];

impl Expectation {
    /// Returns true if an expectation can fail.
    pub fn checks_something(&self) -> bool {
        self.pipeline.is_some()
            || self.states.is_some()
            || self.starts.is_some()
            || self.answers.is_some()
            || !self.comments.is_empty()
    }

    /// Checks what a board has written.
    pub fn check(
        &self,
        model: &[u8],
        samples: &[Sample],
        output: &BoardOutput,
    ) -> anyhow::Result<()> {
        output.check(self.may_restart)?;
        self.check_lines(model, samples, output)?;
        self.check_delay(output)?;
        self.check_reports(output)?;
        self.check_people(output)?;
        self.check_pins(output)?;
        self.check_raw(samples, output)
    }

    fn check_lines(
        &self,
        model: &[u8],
        samples: &[Sample],
        output: &BoardOutput,
    ) -> anyhow::Result<()> {
        let Some(reached) = &self.pipeline else {
            return Ok(());
        };
        let input = |one: &Reached| match *one {
            Reached::Sent(from, to) => {
                let to = to.min(samples.len() / 2);
                Input::Samples(&samples[2 * from..2 * to])
            }
            Reached::Lost(notifications) => Input::Gap(2 * notifications as u32),
            Reached::Disconnected => Input::Disconnected,
            Reached::SilenceMs(ms) => Input::Silence(Millis(ms)),
            Reached::Gate {
                entry,
                other,
                reaction,
            } => Input::SetGate(Gate {
                entry,
                other,
                reaction,
            }),
            Reached::Strength(on) => Input::Strength(on),
        };
        let inputs: Vec<Input<'_>> = reached.iter().map(input).collect();
        let expected = expected_lines(model, &inputs)?;
        let found = output.lines();
        let differs = found
            .iter()
            .zip(&expected)
            .position(|(one, two)| one != two);
        if let Some(place) = differs {
            bail!(
                "line {place}: {}expected: {}",
                found[place],
                expected[place]
            );
        }
        ensure!(
            found.len() == expected.len(),
            "{} lines, expected {}",
            found.len(),
            expected.len()
        );
        Ok(())
    }

    fn check_reports(&self, output: &BoardOutput) -> anyhow::Result<()> {
        let reports = output.reports()?;
        if let Some(expected) = &self.states {
            let states = reports
                .iter()
                .filter(|report| report.kind == ReportKind::State);
            let mut states: Vec<String> = states
                .map(|report| match report.status.cause() {
                    Some(cause) => cause.name().to_owned(),
                    None => "valid".to_owned(),
                })
                .collect();
            states.dedup();
            same("states", &states, expected)?;
        }
        if let Some(expected) = self.counters {
            let last = reports.last().context("no report")?.counters;
            let found = Counters {
                lost: last.lost,
                bridged: last.bridged,
                resets: last.resets,
            };
            ensure!(found == expected, "{found:?}, expected {expected:?}");
        }
        if let Some(expected) = &self.alignments {
            let news = output.alignments()?;
            let found: Vec<_> = news.iter().map(|one| one.state.name().to_owned()).collect();
            same("alignments", &found, expected)?;
        }
        Ok(())
    }

    fn check_people(&self, output: &BoardOutput) -> anyhow::Result<()> {
        let comments = output.comments();
        if let Some(expected) = &self.starts {
            let starts = comments
                .iter()
                .filter_map(|c| c.split_once(", started by "));
            let starts: Vec<_> = starts.map(|(_, reason)| reason.to_owned()).collect();
            same("starts", &starts, expected)?;
        }
        for Comment { text, times, least } in &self.comments {
            let found = comments.iter().filter(|c| c.contains(text)).count();
            ensure!(
                found >= *least && times.is_none_or(|times| found == times),
                "{found} comments with {text:?}, expected {times:?}, at least {least}: {comments:#?}"
            );
        }
        let answers = output.answers();
        if let Some(expected) = &self.answers {
            let fits = |found: &String, wanted: &String| match wanted.strip_suffix('…') {
                Some(start) => found.starts_with(start),
                None => found == wanted,
            };
            let all = answers
                .iter()
                .zip(expected)
                .all(|(one, two)| fits(one, two));
            ensure!(
                all && answers.len() == expected.len(),
                "answers {answers:#?}, expected {expected:#?}"
            );
        }
        for Count { name, least, most } in &self.counts {
            let last = answers.iter().rfind(|a| a.starts_with("OK,COUNTERS,"));
            let numbers = last.context("no answer to COUNTERS")?;
            let place = COUNTS.iter().position(|one| one == name);
            let place = place.with_context(|| format!("no count {name}"))?;
            let number: u32 = numbers
                .split(',')
                .nth(place + 2)
                .context("too few counts")?
                .parse()?;
            ensure!(
                (*least..=*most).contains(&number),
                "{name} is {number}, expected {least} to {most}"
            );
        }
        Ok(())
    }
}

fn same(what: &str, found: &[String], expected: &[String]) -> anyhow::Result<()> {
    ensure!(found == expected, "{what} {found:?}, expected {expected:?}");
    Ok(())
}
