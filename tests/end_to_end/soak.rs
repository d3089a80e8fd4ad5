//! Armband that misbehaves all the time, and a board that keeps its promises.
//!
//! `MYOINTENT_SOAK_SECONDS` sets how long it streams: 70 s of real time by default, which suffices for three incidents
//! with a full window after each; half an hour by hand. The armband has its 200 Hz by the board's clock: both run
//! `MYOINTENT_SOAK_SCALE` times slower than real time. With the default, 3, a busy host disturbs little.

#[path = "soak/observer.rs"]
mod observer;
#[path = "soak/plan.rs"]
mod plan;

use std::cell::RefCell;
use std::str::FromStr;

use anyhow::{Context as _, ensure};
use myointent_tests::emulator::{Run, Scenario, bench};
use myointent_tests::output::Pins;
use shared::intent::Intent;
use shared::model::noise::Noise;
use shared::uart_line::answer::{Answer, Counts};
use shared::units::Sample;

use observer::{Observer, Seen};
use plan::{Incident, KINDS, Plan, SHORTEST};

const SEED: u64 = 42;
const SECONDS: usize = 70;
const TIME_SCALE: u32 = 3;
/// Number of notifications that one wait covers.
const STEP: usize = 50;
/// Samples from a label to the next, unless it changes.
const HOLD: u32 = 20;
/// Smallest number of samples from one label to the next.
const PATCH: u32 = 10;
/// Bytes by which the deepest stack of the second half may exceed that of the first: an interrupt came at a deeper
/// place.
const STACK_GROWTH: u64 = 256;
/// Smallest number of incidents for that comparison: every kind has happened in each half.
const LONG: usize = 2 * KINDS.len();

/// Returns a number that the environment may change.
fn setting<T: FromStr>(name: &str, default: T) -> T {
    std::env::var(name).map_or(default, |text| {
        let number = text.parse().ok();
        number.unwrap_or_else(|| panic!("{name} is {text:?}, expected a number"))
    })
}

/// Returns samples of rest and effort in turn.
fn samples(notifications: usize) -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..2 * notifications)
        .map(|index| {
            let most = if index / 300 % 2 == 1 { 90.0 } else { 3.0 };
            [(); 8].map(|()| (noise.signed() * most) as i8)
        })
        .collect()
}

#[test]
fn an_armband_that_misbehaves_for_minutes_leaves_counters_true_and_no_label_while_not_valid()
-> anyhow::Result<()> {
    let test =
        "an_armband_that_misbehaves_for_minutes_leaves_counters_true_and_no_label_while_not_valid";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let seconds = setting("MYOINTENT_SOAK_SECONDS", SECONDS);
    let time_scale = setting("MYOINTENT_SOAK_SCALE", TIME_SCALE);
    let notifications = (100 * seconds / time_scale as usize).max(SHORTEST);
    let plan = Plan::new(SEED, notifications, time_scale);
    let run = bench.start(&Scenario {
        model: &super::model(),
        page: Some(super::bound()),
        samples: &samples(notifications),
        time_scale,
        pace: 1.0 / f64::from(time_scale),
        fault: None,
        script: plan.script.clone().into(),
        arguments: ["--end", "disconnect"].map(str::to_owned).to_vec(),
    })?;
    let observer = RefCell::new(Observer::new(&run, time_scale));
    let mut soak = Soak {
        run,
        observer,
        exact: 0,
    };
    let mut last = Looked::default();
    let mut stacks = Vec::new();
    for incident in &plan.incidents {
        last = soak.incident(incident, last)?;
        stacks.push(last.seen.stack);
    }
    let stalls = plan.incidents.iter().map(|one| one.counted.stalls).sum();
    last = soak.end(stalls)?;
    let (incidents, exact) = (plan.incidents.len(), soak.exact);
    println!("{notifications} notifications, {incidents} incidents, {exact} exact; {last:?}");
    if incidents >= LONG {
        let (half, end) = (stacks[incidents / 2], last.seen.stack);
        ensure!(end <= half + STACK_GROWTH, "the stack grew: {stacks:?}");
    }
    Ok(())
}

/// Run with its observations.
struct Soak {
    run: Run,
    observer: RefCell<Observer>,
    /// Number of incidents at which the host was quick enough for exact counts.
    exact: usize,
}

/// Counters of the board and of the observer at one time.
#[derive(Clone, Copy, Debug, Default)]
struct Looked {
    counts: Counts,
    seen: Seen,
}

impl Soak {
    /// Waits until so many notifications were sent.
    fn wait_for(&mut self, notifications: usize) -> anyhow::Result<()> {
        // Each step may take as long as a wait may.
        loop {
            let next = notifications.min(self.observer.borrow().sent() + STEP);
            let observer = &self.observer;
            self.run.wait_for(&format!("{next} notifications"), |_| {
                let mut observer = observer.borrow_mut();
                observer.read().is_ok() && observer.sent() >= next
            })?;
            if next == notifications {
                return Ok(());
            }
        }
    }

    /// Asks the board for its counters, and reads what was written.
    fn look(&mut self) -> anyhow::Result<Looked> {
        let body = self.run.ask("$COUNTERS*07\r\n")?;
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let line = format!("${body}*{sum:02X}\r\n");
        let Ok(Answer::Counts(counts)) = Answer::parse(line.as_bytes()) else {
            anyhow::bail!("no counters: {line}");
        };
        let mut observer = self.observer.borrow_mut();
        observer.read()?;
        let seen = observer.seen();
        Ok(Looked { counts, seen })
    }

    /// Waits for an incident and the window after it; checks the board's reaction.
    fn incident(&mut self, incident: &Incident, before: Looked) -> anyhow::Result<Looked> {
        self.wait_for(incident.valid_at())?;
        let first = self.look()?;
        let is_valid = self.is_valid();
        self.wait_for(incident.labelled_to())?;
        let last = self.look()?;
        self.run.check()?;
        self.pins_follow_lines()?;

        let kinds = incident.kinds.join(" and ");
        let failed = || format!("after {kinds}\n{}", self.run.tails());
        counted_always(incident, before, last).with_context(failed)?;
        // A delay of a busy host may look like an armband that stalls, and so samples count as lost that were not.
        let labels = last.seen.labels - first.seen.labels;
        let samples = last.seen.emitted - first.seen.emitted;
        let late = last.seen.late - before.seen.late;
        let now = last.counts.session;
        println!("{kinds}: {late} late; {labels} labels for {samples} samples; {now:?}");
        if late == 0 {
            self.exact += 1;
            counted_exactly(incident, before, last).with_context(failed)?;
            ensure!(is_valid, "not valid a window {}", failed());
            // A label that changes comes sooner.
            let as_often = labels > 0 && (PATCH * labels..=HOLD * labels).contains(&samples);
            ensure!(as_often, "not a label every {HOLD} samples {}", failed());
        }
        Ok(last)
    }

    fn is_valid(&self) -> bool {
        self.run.pins().last().is_some_and(|pins| pins.valid)
    }

    /// Checks that the pins show, one after the other, the labels of the lines.
    fn pins_follow_lines(&self) -> anyhow::Result<()> {
        let mut shown: Vec<(bool, Intent)> = Vec::new();
        for Pins { valid, high, .. } in self.run.pins() {
            shown.push((valid, *high.first().context("no pin is high")?));
        }
        shown.dedup();
        let reports = self.run.reports()?.into_iter();
        let mut said: Vec<_> = reports
            .map(|report| (report.status.valid(), report.status.label()))
            .collect();
        said.dedup();
        // One of the two may be a label ahead.
        let both = shown.len().min(said.len());
        ensure!(
            shown[..both] == said[..both] && shown.len().abs_diff(said.len()) <= 1,
            "the pins do not show what the lines say\n{}",
            self.run.tails()
        );
        Ok(())
    }

    /// Waits for the end of the stream. Checks that everything that was sent was received, unless the board has ended
    /// more connections than planned.
    fn end(&mut self, stalls: u32) -> anyhow::Result<Looked> {
        let observer = &self.observer;
        self.run.wait_for("the end of the recording", |_| {
            let mut observer = observer.borrow_mut();
            observer.read().is_ok() && observer.has_ended()
        })?;
        self.run.wait_for("the end of the connection", |run| {
            let pins = run.pins();
            pins.last().is_some_and(|pins| !pins.armband && !pins.valid)
        })?;
        let last = self.look()?;
        self.run.check()?;
        self.pins_follow_lines()?;
        let (session, sent) = (last.counts.session, last.seen.on_air);
        let taken = session.notifications;
        let as_planned = session.stalls == stalls && session.timeouts == 0;
        ensure!(
            taken == sent || !as_planned && taken < sent,
            "{taken} notifications taken, {sent} sent\n{}",
            self.run.tails()
        );
        Ok(last)
    }
}

/// Checks the board's counts of an incident that hold however busy the host is.
fn counted_always(incident: &Incident, before: Looked, last: Looked) -> anyhow::Result<()> {
    let (one, two) = (before.counts.session, last.counts.session);
    let expected = &incident.counted;
    let malformed = two.malformed - one.malformed;
    ensure!(
        malformed == expected.malformed,
        "{malformed} malformed, expected {}",
        expected.malformed
    );
    // A duplicate that comes late may be the next round of the lanes.
    let duplicates = two.duplicates - one.duplicates;
    ensure!(
        duplicates <= expected.duplicates,
        "{duplicates} duplicates, expected {} at most",
        expected.duplicates
    );
    let made = two.connections - one.connections;
    let (streams, refused) = (
        last.seen.connections - before.seen.connections,
        last.seen.refusals - before.seen.refusals,
    );
    ensure!(
        (streams..=streams + refused).contains(&made),
        "{made} connections, the armband had {streams} and closed {refused} at once"
    );
    let dropped = [last.counts.packets_dropped, last.counts.lines_dropped];
    ensure!(dropped == [0, 0], "packets and lines dropped: {dropped:?}");
    Ok(())
}

/// Checks the board's counts of an incident that hold only where the host did not disturb.
fn counted_exactly(incident: &Incident, before: Looked, last: Looked) -> anyhow::Result<()> {
    let (one, two) = (before.counts.session, last.counts.session);
    let expected = &incident.counted;
    let found = [
        two.duplicates - one.duplicates,
        two.reordered - one.reordered,
        two.stalls - one.stalls,
        two.timeouts - one.timeouts,
    ];
    let wanted = [expected.duplicates, expected.reordered, expected.stalls, 0];
    ensure!(
        found == wanted,
        "duplicates, swaps, stalls and time-outs {found:?}, expected {wanted:?}"
    );
    let lost = two.lost - one.lost;
    ensure!(
        expected.lost.contains(&lost),
        "{lost} samples lost, expected {:?}",
        expected.lost
    );
    Ok(())
}
