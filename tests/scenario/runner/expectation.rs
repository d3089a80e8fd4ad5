//! What has to come of a scenario.

mod pins;

use super::installed;
use anyhow::{Context as _, bail, ensure};
use myointent_tests::emulator::{Input, expected_lines};
use myointent_tests::output::Output;
use serde::Deserialize;
use shared::stream::alignment::Alignment;
use shared::stream::smoother::{Gate, Reaction};
use shared::uart_line::Kind;
use shared::units::{Millis, Sample};

/// What has to come of a scenario; only what is given is checked.
#[derive(Deserialize, Clone, Default)]
#[serde(deny_unknown_fields, default)]
pub struct Expectation {
    /// The numbered lines are those of the pipeline for these inputs.
    pipeline: Option<Vec<Reached>>,
    /// Why the board was safe, from `$STATE` line to `$STATE` line, `valid` where it was not; equal neighbours count once.
    states: Option<Vec<String>>,
    /// Why the program started, each time.
    starts: Option<Vec<String>>,
    /// Comments that come so often.
    comments: Vec<Comment>,
    /// Bodies of the answers; one that ends in `…` may go on.
    answers: Option<Vec<String>>,
    /// States of alignments.
    alignments: Option<Vec<String>>,
    /// How often `valid` rises.
    rises: Option<usize>,
    /// The counters of the last report.
    counters: Option<Counters>,
    /// Milliseconds from the fault to safe pins, at most.
    safe_within_ms: Option<u32>,
    /// Raw samples are those that were sent, from some sample on, without a hole.
    raw_without_holes: bool,
    /// At least so many lines with raw samples.
    raw_at_least: Option<usize>,
    /// Counts that `COUNTERS` answered with last: by name, at least and at most.
    counts: Vec<Count>,
    /// Mean and longest time from the newest sample that a label depends on to the pins, in tenths of a millisecond: of all
    /// labels that change the pins. Virtual time repeats, so both are exact.
    delay_tenths_ms: Option<(u32, u32)>,
    /// After an installation the labels are those of the new model, from the samples that came before and since.
    labels_of_installed: bool,
    /// Whether the board may restart.
    may_restart: bool,
    /// The region holds the file that was installed.
    pub installed: bool,
    /// Events in the virtual armband's log, which the simulated one does not have.
    armband: Vec<Happened>,
}

/// An event in the virtual armband's log.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
struct Happened {
    event: String,
    #[serde(default)]
    least: usize,
    #[serde(default = "often")]
    most: usize,
}

const fn often() -> usize {
    usize::MAX
}

/// The models of a scenario.
#[derive(Clone, Copy)]
pub struct Models<'m> {
    /// That of the region at first.
    pub first: &'m [u8],
    /// The one that is installed.
    pub other: &'m [u8],
}

/// What reached the pipeline.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum Reached {
    /// Notifications from the first to before the second number.
    Sent(usize, usize),
    /// So many notifications are lost.
    Lost(usize),
    /// The connection has ended.
    Disconnected,
    /// Nothing comes for so many milliseconds.
    SilenceMs(u32),
    /// An alignment is set: places, mirrored.
    Align(u8, bool),
    /// The operating point is changed: margins in hundredths.
    Gate {
        entry: Option<i16>,
        other: Option<i16>,
        reaction: Option<Reaction>,
    },
    /// An installation begins to write.
    Suspended,
    /// The other model is in use.
    Installed,
}

/// A comment line.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
struct Comment {
    /// What it contains.
    text: String,
    /// How many there are.
    times: Option<usize>,
    /// At least so many.
    #[serde(default)]
    least: usize,
}

/// Of the link.
#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(deny_unknown_fields)]
struct Counters {
    lost: u32,
    bridged: u32,
    resets: u32,
}

/// Of an answer to `COUNTERS`.
#[derive(Deserialize, Clone)]
#[serde(deny_unknown_fields)]
struct Count {
    /// As README.md names them.
    name: String,
    #[serde(default)]
    least: u32,
    #[serde(default = "any")]
    most: u32,
}

const fn any() -> u32 {
    u32::MAX
}

/// The counts of an answer to `COUNTERS`, in its order.
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
    /// Whether anything is expected that can fail.
    pub fn checks_something(&self) -> bool {
        self.pipeline.is_some()
            || self.states.is_some()
            || self.starts.is_some()
            || self.answers.is_some()
            || !self.comments.is_empty()
    }

    /// Checks what a board has written.
    ///
    /// # Errors
    /// Says what is not as expected.
    pub fn check(
        &self,
        models: Models<'_>,
        samples: &[Sample],
        output: &Output,
    ) -> anyhow::Result<()> {
        output.check(self.may_restart)?;
        self.check_lines(models, samples, output)?;
        self.check_delay(output)?;
        installed::check(self.labels_of_installed, models, samples, output)?;
        self.check_reports(output)?;
        self.check_people(output)?;
        self.check_pins(output)?;
        self.check_raw(samples, output)
    }

    /// Checks what the virtual armband has seen.
    ///
    /// # Errors
    /// Says what is not as expected.
    pub fn check_armband(&self, output: &Output) -> anyhow::Result<()> {
        for Happened { event, least, most } in &self.armband {
            let found = output.event_count(event);
            ensure!(
                (*least..=*most).contains(&found),
                "{found} times {event}, expected {least} to {most}"
            );
        }
        Ok(())
    }

    fn check_lines(
        &self,
        models: Models<'_>,
        samples: &[Sample],
        output: &Output,
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
            Reached::Align(turn, mirrored) => Input::SetAlignment(Alignment::new(turn, mirrored)),
            Reached::Gate {
                entry,
                other,
                reaction,
            } => Input::SetGate(Gate {
                entry,
                other,
                reaction,
            }),
            Reached::Suspended => Input::Suspend,
            Reached::Installed => Input::Resume(models.other),
        };
        let inputs: Vec<Input<'_>> = reached.iter().map(input).collect();
        let expected = expected_lines(models.first, &inputs)?;
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

    fn check_reports(&self, output: &Output) -> anyhow::Result<()> {
        let reports = output.reports()?;
        if let Some(expected) = &self.states {
            let states = reports.iter().filter(|report| report.kind == Kind::State);
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

    fn check_people(&self, output: &Output) -> anyhow::Result<()> {
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
