//! Loss of power at every operation of flash of an installation, and a line that is pulled at every block.

use std::collections::BTreeSet;
use std::ops::Range;

use anyhow::{Context as _, ensure};
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::simulation::{self, FlashOperation, Inputs, Ran, Start};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::stream::safe_state::Cause;
use shared::uart_line::command::MAX_COMMAND_BYTES;
use shared::uart_line::{Kind, Report};
use shared::units::Sample;

use super::plan::{Content, Cut, plan};
use super::{cuts, model, page, program, samples};

/// Line that the board writes while an installation is not complete.
const INCOMPLETE: &str = "# no model: an installation is not complete; `myointent board --port PATH install FILE` with the same \
     file goes on with it";
/// Number of notifications before the installation.
const AT: usize = 400;
/// Seconds of a run: the installation takes 20, a restart and the first window after it 5.
const RUN_SECONDS: usize = 36;
/// Seconds of samples: more than any run has.
const SECONDS: usize = 64;
/// Operations of a page: erasure, blocks, mark. The first page's at the end has no mark, but the end of the journal.
const PAGE_OPERATIONS: usize = 66;

/// Board with one model, on which another one is installed.
struct Bench {
    old: Vec<u8>,
    new: Vec<u8>,
    samples: Vec<Sample>,
}

/// Parts of a label that do not depend on the lines before: reference, emission, name.
type Label = (u32, u32, &'static str);

impl Bench {
    fn new() -> Self {
        Self {
            old: model("three-class"),
            new: model("five-class"),
            samples: samples(SECONDS),
        }
    }

    /// Runs an installation with faults: keys of the scenario, keys of the installation.
    fn install(&self, seconds: usize, scenario: &str, installation: &str) -> anyhow::Result<Ran> {
        let text = format!(
            "run_seconds = {seconds}\n{scenario}\nperson = [{{ do = \"install\", at = {AT}{installation} }}]\n"
        );
        simulation::run(
            program(),
            &Inputs {
                scenario: &text,
                model: &self.old,
                samples: &self.samples,
                page: &page(),
                install: Some(&self.new),
            },
        )
    }

    /// Checks the result of power that failed after one start after the other.
    fn check_power(&self, ran: &Ran, flash: &[FlashOperation], cuts: &[Cut]) -> anyhow::Result<()> {
        ran.check(true)?;
        ensure!(
            ran.region.starts_with(&self.new),
            "the region holds no new model"
        );
        let starts = ran.starts()?;
        ensure!(starts.len() == cuts.len() + 1, "{} starts", starts.len());
        let comments = ran.comments();
        let is_start = |comment: &String| comment.starts_with("# myointent ");
        let names: Vec<_> = comments.iter().filter(|one| is_start(one)).collect();
        let said: Vec<_> = comments.split(is_start).skip(1).collect();
        let reports = ran.reports_by_start()?;
        ensure!(
            names.len() == starts.len() && reports.len() == starts.len(),
            "{names:#?}"
        );
        for number in 0..=cuts.len() {
            let cut = number.checked_sub(1).map(|before| cuts[before]);
            let content = cut.map_or(Content::Old, |cut| cut.content(flash));
            let power_fails = number < cuts.len();
            self.check_start(content, names[number], said[number].first())
                .and_then(|()| check_states(content, number == 0, power_fails, &reports[number]))
                .with_context(|| format!("after {cut:?}"))?;
        }
        let pins = ran.pins();
        let rises = pins.windows(2).filter(|two| !two[0].valid && two[1].valid);
        ensure!(rises.count() == 2, "valid between two losses of power");
        let (before, last) = (&starts[cuts.len() - 1], &starts[cuts.len()]);
        let from = before.loss.context("power did not fail")?.packets;
        let (_, to) = last.packets.last().context("no stream after it")?;
        let rest = &self.samples[2 * from..2 * (to + 1)];
        let reports = &reports[cuts.len()];
        match cuts[cuts.len() - 1].content(flash) {
            Content::Old => self.check_resumed(last, reports, rest, from),
            Content::Neither | Content::New => {
                same(&labels(reports), &self.expected(&[Input::Samples(rest)])?)
            }
        }
    }

    /// Checks a start's first line, which names the model that runs, and the next one, which says why there is none.
    fn check_start(
        &self,
        content: Content,
        name: &str,
        next: Option<&String>,
    ) -> anyhow::Result<()> {
        let model = match content {
            Content::Old => format!("{:08x}", crc(&self.old)),
            Content::Neither => "refused".to_owned(),
            Content::New => format!("{:08x}", crc(&self.new)),
        };
        let end = format!(" model {model}, started by power or reset");
        ensure!(name.ends_with(&end), "{name}, expected {content:?}");
        let is_incomplete = next.is_some_and(|next| next == INCOMPLETE);
        ensure!(is_incomplete == (content == Content::Neither), "{next:?}");
        Ok(())
    }

    /// Checks the result of a line that was pulled.
    fn check_line(&self, ran: &Ran) -> anyhow::Result<()> {
        ran.check(false)?;
        let reports = ran.reports()?;
        let causes = states(&reports);
        let whole = [Some(Cause::Boot), None, Some(Cause::Installation), None];
        ensure!(causes == whole, "states {causes:?}");
        ensure!(
            ran.comments().contains(&INCOMPLETE.to_owned()),
            "it does not say what is missing"
        );
        let answers = ran.answers();
        let refusals = answers.iter().filter(|answer| answer.starts_with("ERR"));
        ensure!(refusals.count() == 0, "it refused: {answers:#?}");
        ensure!(
            answers.last().is_some_and(|last| last == "OK,INSTALL,done"),
            "{answers:#?}"
        );
        ensure!(
            ran.region.starts_with(&self.new),
            "the region holds no new model"
        );
        let starts = ran.starts()?;
        self.check_resumed(&starts[0], &reports, &self.samples, 0)
    }

    /// Checks that the labels after an installation in a stream are those of the new model, encoded from all samples in
    /// the window. `samples` are those since the start, the first one from the packet `first`.
    fn check_resumed(
        &self,
        start: &Start,
        reports: &[Report],
        samples: &[Sample],
        first: usize,
    ) -> anyhow::Result<()> {
        let suspended = |report: &&Report| report.status.cause() == Some(Cause::Installation);
        let suspended = reports
            .iter()
            .find(suspended)
            .context("never suspended")?
            .emitted
            .0 as usize;
        let found = labels(reports).split_off(labels_until(reports, suspended));
        ensure!(found.len() > 20, "{} labels", found.len());
        // The number is 0 before any sample as well as at the first.
        let before = if suspended == 0 { 0 } else { suspended + 1 };
        for packet in resumed(start)? {
            let to = 2 * (packet - first);
            let inputs = [
                Input::Samples(&samples[..before]),
                Input::Suspend,
                Input::Samples(&samples[before..to]),
                Input::Resume(&self.new),
                Input::Samples(&samples[to..]),
            ];
            let expected = parsed(&expected_lines(&self.old, &inputs)?)?;
            let expected = labels(&expected).split_off(labels_until(&expected, suspended));
            if expected.starts_with(&found) {
                return Ok(());
            }
        }
        anyhow::bail!("other labels after the installation: {found:?}")
    }

    fn expected(&self, inputs: &[Input<'_>]) -> anyhow::Result<Vec<Label>> {
        Ok(labels(&parsed(&expected_lines(&self.new, inputs)?)?))
    }
}

/// Checks the causes of the safe state after a start with this content; if power fails in the installation, up to then.
fn check_states(
    content: Content,
    is_first: bool,
    power_fails: bool,
    reports: &[Report],
) -> anyhow::Result<()> {
    let installing = Some(Cause::Installation);
    let whole: &[Option<Cause>] = match content {
        Content::Old if is_first => &[Some(Cause::Boot), None, installing],
        Content::Old => &[Some(Cause::Boot), installing, None],
        Content::Neither => &[Some(Cause::ModelRefused), installing, None],
        Content::New => &[Some(Cause::Boot), None],
    };
    let until = whole.iter().position(|one| *one == installing);
    let until = until.map_or(whole.len(), |place| place + 1);
    let states = states(reports);
    let is_right = if power_fails {
        // The last line may still be on its way when power fails.
        states == whole[..until] || states == whole[..until - 1]
    } else {
        states == whole
    };
    ensure!(is_right, "states {states:?}, of {whole:?}");
    Ok(())
}

/// Returns the packets before which the new model may have come into use: those queued while the journal's page was
/// erased.
fn resumed(start: &Start) -> anyhow::Result<Range<usize>> {
    let end = start.flash.last().context("nothing was written")?.at_us;
    let after = start.packets.iter().position(|(at, _)| *at > end);
    let (_, number) = start.packets[after.context("no packet after it")?];
    Ok(number..number + 12)
}

fn crc(file: &[u8]) -> u32 {
    u32::from_le_bytes(*file.last_chunk().unwrap())
}

fn parsed(lines: &[String]) -> anyhow::Result<Vec<Report>> {
    let reports = lines.iter().map(|line| Report::parse(line.as_bytes()));
    Ok(reports.collect::<Result<_, _>>()?)
}

/// Returns the number of labels emitted up to a sample.
fn labels_until(reports: &[Report], sample: usize) -> usize {
    let labels = reports.iter().filter(|report| report.kind == Kind::Label);
    let until = labels.take_while(|report| report.emitted.0 as usize <= sample);
    until.count()
}

fn states(reports: &[Report]) -> Vec<Option<Cause>> {
    let states = reports.iter().filter(|report| report.kind == Kind::State);
    let mut states: Vec<_> = states.map(|report| report.status.cause()).collect();
    states.dedup();
    states
}

fn labels(reports: &[Report]) -> Vec<Label> {
    let labels = reports.iter().filter(|report| report.kind == Kind::Label);
    labels
        .map(|report| {
            let name = report.status.label().name();
            (report.instant.0, report.emitted.0, name)
        })
        .collect()
}

fn same(found: &[Label], expected: &[Label]) -> anyhow::Result<()> {
    ensure!(found.len() > 20, "{} labels", found.len());
    let differs = found.iter().zip(expected).position(|(one, two)| one != two);
    if let Some(place) = differs {
        anyhow::bail!("{:?}, expected {:?}", found[place], expected[place]);
    }
    // The last label may still be on its way.
    ensure!(
        expected.len() - found.len() <= 1,
        "{} of {} labels",
        found.len(),
        expected.len()
    );
    Ok(())
}

#[test]
fn power_that_fails_at_any_operation_of_flash_leaves_a_safe_board_that_the_same_command_completes()
{
    let bench = Bench::new();
    let whole = bench.install(RUN_SECONDS, "", "").unwrap();
    bench.check_line(&whole).unwrap();
    let starts = whole.starts().unwrap();
    let flash = &starts[0].flash;
    let blocks = bench.new.len().div_ceil(64);
    // The journal is erased, written and erased; every block is written; every page is erased, the first one twice,
    // and marked but for the first.
    let pages = bench.new.len().div_ceil(4096);
    assert_eq!(flash.len(), 3 + blocks + (pages + 1) + (pages - 1));
    let seed = cuts::seed();
    let mut plans: Vec<_> = (0..PAGE_OPERATIONS)
        .map(|number| plan(flash, number, seed))
        .collect();
    let planned: BTreeSet<_> = plans.iter().flatten().map(|cut| cut.operation).collect();
    assert_eq!(planned.len(), flash.len());
    // These cuts leave the old model in use; the installation must still complete.
    plans
        .extend([(0, 50), (1, 100), (2, 0)].map(|(operation, done)| vec![Cut { operation, done }]));
    let must = [
        0,
        PAGE_OPERATIONS - 2,
        PAGE_OPERATIONS - 1,
        PAGE_OPERATIONS,
        plans.len() - 1,
    ];
    cuts::each(plans.len(), &must, 3, seed, |number| {
        let cuts = &plans[number];
        let mut first = 0;
        let fails: Vec<_> = cuts
            .iter()
            .map(|cut| {
                let number = cut.operation - first + 1;
                first = cut.goes_on_at(flash);
                number
            })
            .collect();
        let done: Vec<_> = cuts.iter().map(|cut| cut.done).collect();
        let fails = format!("power_fails_at = {fails:?}\npower_fails_done = {done:?}");
        let ran = bench.install(
            RUN_SECONDS + cuts.len() * number / PAGE_OPERATIONS,
            &fails,
            "",
        )?;
        let checked = bench.check_power(&ran, flash, cuts);
        checked.with_context(|| ran.tails())
    });
}

#[test]
fn a_line_that_is_pulled_at_every_block_of_an_installation_is_gone_on_with_where_it_was() {
    /// Milliseconds of a pull and of the lines after it.
    const PULL_MS: usize = 130;
    let seed = cuts::seed();
    println!("MYOINTENT_SEED={seed}");
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let new = model("five-class");
    let blocks = new.len().div_ceil(64);
    let after: Vec<_> = (0..blocks).collect();
    // The line is pulled within the block's line, or behind it, where the answer is lost.
    let bytes = after
        .iter()
        .map(|_| random.random_range(0..=MAX_COMMAND_BYTES + 2));
    let bytes: Vec<_> = bytes.collect();
    let seconds = RUN_SECONDS + blocks * PULL_MS / 1000;
    let bench = Bench {
        samples: samples(seconds),
        ..Bench::new()
    };
    let pulled = format!(", pulled_after = {after:?}, pulled_byte = {bytes:?}, pulled_ms = 100");
    let ran = bench.install(seconds, "", &pulled).unwrap();
    bench.check_line(&ran).unwrap();
    let answers = ran.answers();
    let begun = answers
        .iter()
        .filter(|answer| answer.starts_with("OK,INSTALL,"));
    // The board answers each block, and each question where it goes on, once, received or not.
    assert_eq!(begun.count(), 2 * blocks + 1);
}
