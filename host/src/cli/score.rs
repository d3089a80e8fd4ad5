//! `myointent score`: any predicted label sequence against the true one.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use shared::intent::Intent;
use shared::units::{SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ};

use evaluation::metric::confusion::Confusion;
use evaluation::metric::event::activation::Rate;
use evaluation::metric::event::gesture::Gesture;
use evaluation::metric::event::latency::{Latency, LatencySummary};
use evaluation::metric::event::summary::{Raised, SubjectEvents};
use evaluation::metric::event::{EventRule, RecordingEvents};
use evaluation::metric::offset;
use evaluation::metric::predicted_length;
use evaluation::metric::summary::RecordingScore;
use evaluation::metric::transition::{Change, Rule, TransitionStatus};
use evaluation::report::Table;
use recordings::labels::motion::{GroundTruth, Motion};
use recordings::labels::vocabulary;
use recordings::movement;
pub use recordings::readers::label_file::{self, Purpose};

/// Arguments of `myointent score`.
#[derive(clap::Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = "Scores one recording's predicted labels against the true ones: balanced and raw accuracy, \
        transition accuracy with the reason of every failure, signed offsets, and events: gestures recognised with \
        their latency, false activations, flicker. docs/metrics.md has the definitions.\n\n\
        Files: npy (one axis of class numbers or names, or ReactEMG's n x 9), or text with one \
        label per line, or csv with a header. Of a csv, --truth reads the column gt, truth or label, and --prediction \
        reads prediction, predicted or label, the first of them that there is. Labels \
        are class numbers (0 relax, 1 open, 2 close, 3 wave-in, 4 wave-out, 5 pinch) or names; \
        -1, unknown or none: no label; -2, other or its name (point): other movement, as a prediction no label. Both files have one label per sample at 200 Hz.\n\n\
        A transition of the truth is followed if the prediction changes the same way within the \
        buffer around it, without a third label there, and then holds the new label until the \
        next buffer. Where transitions are near each other, buffers do not overlap: a buffer starts where the one before it \
        ends at the earliest, and ends one sample before the last sample of its label, if the next transition comes so early. Then \
        there is nothing to hold. A true label of a single sample has no buffer and is refused. Unlabelled samples \
        divide the truth into parts that are scored separately; samples after the last prediction are not scored.\n\n\
        Events take a label at the sample where it stands, as the time at which it is emitted. Files of `predict` have \
        labels at the times that they are for: give --delay 51, the look-ahead of 0.25 s and the sample that the median \
        waits for.\n\nExamples:\n  \
        myointent score --truth s1_grasp.csv --prediction labels.csv --delay 51\n  \
        myointent score --truth truth.npy --prediction labels.npy --buffer 120 --json"
)]
pub struct Arguments {
    /// True labels
    #[arg(long)]
    truth: PathBuf,
    /// Predicted labels
    #[arg(long)]
    prediction: PathBuf,
    /// Width of the buffer around a transition, both sides together, in samples (paper: 200)
    #[arg(long, default_value_t = Rule::default().buffer)]
    buffer: usize,
    /// After the new label, allow no other
    #[arg(long)]
    strict: bool,
    /// Allow relax in the buffer and while the new label is held
    #[arg(long)]
    allow_relax: bool,
    /// Samples from the place of a predicted label to its emission, for the events
    #[arg(long, value_name = "SAMPLES", default_value_t = 0)]
    delay: usize,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs `myointent score`.
///
/// # Errors
/// If a file cannot be read or the two do not fit.
pub(super) fn run(args: Arguments) -> anyhow::Result<()> {
    let report = report(&args)?;
    std::io::stdout().write_all(report.as_bytes())?;
    Ok(())
}

/// Formats the scores as text or JSON.
fn report(args: &Arguments) -> anyhow::Result<String> {
    let truth: GroundTruth = label_file::read(&args.truth, Purpose::Truth)?
        .into_iter()
        .collect();
    let movements = truth.other_movement;
    let truth = truth.labels;
    // Other movement raises no label: predicted, it is none.
    let prediction: Vec<Option<Intent>> = label_file::read(&args.prediction, Purpose::Prediction)?
        .into_iter()
        .map(Motion::label)
        .collect();
    let rule = Rule {
        buffer: args.buffer,
        strict: args.strict,
        allow_relax: args.allow_relax,
    };
    let name = args.prediction.display().to_string();
    let score = RecordingScore::new("", &name, &truth, &prediction, &rule)
        .with_context(|| format!("cannot score {} against {}", name, args.truth.display()))?;
    let mut confusion = Confusion::new(vocabulary::smallest(truth.iter().chain(&prediction)));
    let scored = predicted_length(&prediction);
    confusion.add(&truth[..scored], &prediction[..scored])?;
    let emitted = delayed(&prediction[..scored], args.delay);
    let movements = movement::within(&movements, &(0..scored));
    let events = RecordingEvents::new(
        &truth[..scored],
        &emitted,
        &movements,
        &EventRule::default(),
    )?;
    Ok(if args.json {
        json(&score, &events, &rule, &confusion)?
    } else {
        tables(&score, &events, truth.len() - scored, &confusion)
    })
}

/// Delays labels by a number of samples.
fn delayed(labels: &[Option<Intent>], samples: usize) -> Vec<Option<Intent>> {
    let kept = labels.len().saturating_sub(samples);
    let before = std::iter::repeat_n(None, labels.len() - kept);
    before.chain(labels[..kept].iter().copied()).collect()
}

fn json(
    score: &RecordingScore,
    events: &RecordingEvents,
    rule: &Rule,
    confusion: &Confusion,
) -> serde_json::Result<String> {
    let own = SubjectEvents::new("", [events]);
    let per_minute = |rate: Rate| serde_json::json!({"count": rate.count, "seconds": rate.seconds, "per_minute": rate.per_minute()});
    let recalls: BTreeMap<&str, f64> = Intent::ALL
        .into_iter()
        .filter_map(|intent| Some((intent.name(), score.recalls.recall(intent)?)))
        .collect();
    let offsets: Vec<i32> = score.transitions.offsets().collect();
    let report = serde_json::json!({
        "rule": rule,
        "event_rule": EventRule::default(),
        "balanced_accuracy": score.recalls.balanced_accuracy(),
        "recalls": recalls,
        "gestures_recognised": own.recognised,
        "recognition": own.recognition,
        "latency": own.latency,
        "false_activations": per_minute(own.rest),
        "other_activations": per_minute(own.other_movement),
        "other_movements": own.raised,
        "flicker": per_minute(own.flicker),
        "gestures": events.gestures,
        "raw_accuracy": score.raw_accuracy,
        "transition_accuracy": score.transitions.accuracy(),
        "correct": score.transitions.correct(),
        "events": score.transitions.events(),
        "offset_ms": offset::summary(&offsets),
        "changes": score.transitions.changes,
        "constant": score.transitions.constant,
        "confusion": confusion,
    });
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

fn tables(
    score: &RecordingScore,
    events: &RecordingEvents,
    unscored: usize,
    confusion: &Confusion,
) -> String {
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let transitions = &score.transitions;
    let own = SubjectEvents::new("", [events]);
    let per_minute = |rate: Rate| {
        let value = rate.per_minute();
        let value = value.map_or("-".to_owned(), |value| format!("{value:.1}"));
        format!("{value} a minute ({} in {:.1} s)", rate.count, rate.seconds)
    };
    let mut text = format!(
        "balanced accuracy    {}\ntransition accuracy  {} ({} of {})\n",
        share(score.recalls.balanced_accuracy()),
        share(transitions.accuracy()),
        transitions.correct(),
        transitions.events()
    );
    text += &format!(
        "gestures recognised  {} ({} of {})\n",
        share(own.recognition),
        own.recognised,
        own.gestures
    );
    if let Some(LatencySummary { median, p90 }) = own.latency {
        let of = |latency| match latency {
            Latency::Ms(ms) => format!("{ms:.0} ms"),
            Latency::Missed => "missed".to_owned(),
        };
        text += &format!(
            "latency              median {}, 90 % {}\n",
            of(median),
            of(p90)
        );
    }
    text += &format!("false activations    {} of rest\n", per_minute(own.rest));
    if let Some(raised) = own.raised.values().copied().reduce(Raised::plus) {
        text += &format!(
            "other movements      {} of {} raise a label; {}\n",
            raised.raised,
            raised.movements,
            per_minute(own.other_movement)
        );
    }
    text += &format!("flicker              {}\n", per_minute(own.flicker));
    text += &format!("raw accuracy         {}\n", share(score.raw_accuracy));
    let offsets: Vec<i32> = transitions.offsets().collect();
    if let Some(offset) = offset::summary(&offsets) {
        text += &format!(
            "offset               mean {:+.0} ms, median {:+.0} ms; absolute mean {:.0} ms\n",
            offset.signed.mean, offset.signed_median, offset.absolute.mean
        );
    }
    if unscored > 0 {
        text +=
            &format!("not scored           the last {unscored} samples, without a prediction\n");
    }
    if !transitions.changes.is_empty() {
        text += &format!("\n{}", changes(&transitions.changes).plain());
    }
    let mut reasons: BTreeMap<TransitionStatus, usize> = BTreeMap::new();
    for change in transitions
        .changes
        .iter()
        .filter(|change| change.status != TransitionStatus::Ok)
    {
        *reasons.entry(change.status).or_default() += 1;
    }
    for (status, count) in reasons {
        text += &format!("{count} x {}: {}\n", status.code(), status.reason());
    }
    if !events.gestures.is_empty() {
        text += &format!("\n{}", gestures(&events.gestures).plain());
    }
    text + "\n" + &matrix(confusion).plain()
}

fn changes(changes: &[Change]) -> Table {
    let mut table = Table::new("", ["sample", "at s", "change", "status", "offset ms"]);
    for change in changes {
        let offset = change.offset.map_or_else(String::new, |samples| {
            format!("{:+}", i64::from(samples) * i64::from(SAMPLE_PERIOD_MS))
        });
        table.push([
            change.at.to_string(),
            format!("{:.2}", change.at as f64 / f64::from(SAMPLE_RATE_HZ)),
            format!("{} -> {}", change.from.name(), change.to.name()),
            change.status.code().to_owned(),
            offset,
        ]);
    }
    table
}

fn gestures(gestures: &[Gesture]) -> Table {
    let mut table = Table::new("", ["onset", "at s", "gesture", "verdict", "latency ms"]);
    for gesture in gestures {
        let latency = gesture.latency.map_or_else(String::new, |samples| {
            format!("{:+}", i64::from(samples) * i64::from(SAMPLE_PERIOD_MS))
        });
        let onset = gesture.span.start;
        table.push([
            onset.to_string(),
            format!("{:.2}", onset as f64 / f64::from(SAMPLE_RATE_HZ)),
            gesture.label.name().to_owned(),
            gesture.verdict.reason().to_owned(),
            latency,
        ]);
    }
    table
}

fn matrix(confusion: &Confusion) -> Table {
    let columns = [&["truth"], &confusion.intents[..], &["none"]].concat();
    let caption = "Samples by true (row) and predicted (column) label:";
    let mut table = Table::new(caption, columns);
    for (intent, counts) in confusion.intents.iter().zip(&confusion.counts) {
        let counts = counts.iter().map(ToString::to_string);
        table.push(std::iter::once((*intent).to_owned()).chain(counts));
    }
    table
}

#[cfg(test)]
mod tests;
