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
        Events, and the scores at emission, take labels at the times when they are emitted: the column emitted of a csv of \
        `predict`, or the prediction moved by --delay.\n\nExamples:\n  \
        myointent score --truth s1_grasp.csv --prediction labels.csv\n  \
        myointent score --truth s1_grasp.csv --prediction other.csv --delay 51\n  \
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
    /// Samples from the place of a predicted label to its emission, if the file does not say [default: 0]
    #[arg(long, value_name = "SAMPLES")]
    delay: Option<usize>,
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
    let labels = |motions: Vec<Motion>| -> Vec<Option<Intent>> {
        motions.into_iter().map(Motion::label).collect()
    };
    let prediction = labels(label_file::read(&args.prediction, Purpose::Prediction)?);
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
    let emitted = match args.delay {
        Some(_) => None,
        None => label_file::read_if_named(&args.prediction, Purpose::Emission)?,
    };
    let emitted = match emitted.map(labels) {
        Some(mut emitted) => {
            emitted.truncate(scored);
            emitted
        }
        None => delayed(&prediction[..scored], args.delay.unwrap_or(0)),
    };
    let movements = movement::within(&movements, &(0..scored));
    let own = &truth[..scored];
    let scores = Scores {
        emission: RecordingScore::new("", &name, own, &emitted, &rule)?,
        events: RecordingEvents::new(own, &emitted, &movements, &EventRule::default())?,
        reference: score,
    };
    Ok(if args.json {
        json(&scores, &rule, &confusion)?
    } else {
        tables(&scores, truth.len() - scored, &confusion)
    })
}

/// Scores of both times of a label.
struct Scores {
    /// Labels at the times that they are for.
    reference: RecordingScore,
    /// Labels at the times when they are emitted.
    emission: RecordingScore,
    /// Events, of labels when they are emitted.
    events: RecordingEvents,
}

/// Delays labels by a number of samples.
fn delayed(labels: &[Option<Intent>], samples: usize) -> Vec<Option<Intent>> {
    let kept = labels.len().saturating_sub(samples);
    let before = std::iter::repeat_n(None, labels.len() - kept);
    before.chain(labels[..kept].iter().copied()).collect()
}

fn json(scores: &Scores, rule: &Rule, confusion: &Confusion) -> serde_json::Result<String> {
    let Scores {
        reference: score,
        emission,
        events,
    } = scores;
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
        "recognised_within_ms": SOON_MS.map(|ms| (ms.to_string(), own.recognised_within(ms))).into_iter().collect::<BTreeMap<_, _>>(),
        "false_activations": per_minute(own.rest),
        "other_activations": per_minute(own.other_movement),
        "other_movements": own.raised,
        "flicker": per_minute(own.flicker),
        "gestures": events.gestures,
        "raw_accuracy": score.raw_accuracy,
        "transition_accuracy": score.transitions.accuracy(),
        "at_emission": {
            "balanced_accuracy": emission.recalls.balanced_accuracy(),
            "transition_accuracy": emission.transitions.accuracy(),
        },
        "correct": score.transitions.correct(),
        "events": score.transitions.events(),
        "offset_ms": offset::summary(&offsets),
        "changes": score.transitions.changes,
        "constant": score.transitions.constant,
        "confusion": confusion,
    });
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

/// Times after the onset of a gesture, in ms, for which the share that is recognised by then is told.
const SOON_MS: [u32; 4] = [100, 150, 200, 300];

fn tables(scores: &Scores, unscored: usize, confusion: &Confusion) -> String {
    let Scores {
        reference: score,
        emission,
        events,
    } = scores;
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
        "when emitted         balanced {}, transition {}\n",
        share(emission.recalls.balanced_accuracy()),
        share(emission.transitions.accuracy())
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
    if own.gestures > 0 {
        let soon = SOON_MS.map(|ms| format!("{} in {ms} ms", share(own.recognised_within(ms))));
        text += &format!("so soon              {}\n", soon.join(", "));
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
