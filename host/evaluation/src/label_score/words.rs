//! Scores of a label sequence as JSON and as text.

use std::collections::BTreeMap;

use serde_json::Value;
use shared::intent::Intent;
use shared::units::{SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ};

use super::LabelScore;
use crate::metric::confusion::Confusion;
use crate::metric::event::TOLERANCE;
use crate::metric::event::activation::Rate;
use crate::metric::event::gesture::Gesture;
use crate::metric::event::summary::{SubjectEvents, Tally};
use crate::metric::offset;
use crate::metric::transition::{Change, TransitionStatus};
use crate::report::Table;
use crate::report::cell::latency_in_words;

/// Times after the onset of a gesture, in ms, for which the share that is recognised by then is told.
const SOON_MS: [u32; 4] = [100, 150, 200, 300];

impl LabelScore {
    /// Scores as JSON; the names are those of docs/metrics.md.
    pub fn json(&self) -> Value {
        let LabelScore {
            reference: score,
            emission,
            events,
            confusion,
            rule,
            ..
        } = self;
        let own = SubjectEvents::new("", [events]);
        let per_minute = |rate: Rate| serde_json::json!({"count": rate.count, "seconds": rate.seconds, "per_minute": rate.per_minute()});
        let recalls: BTreeMap<&str, f64> = Intent::ALL
            .into_iter()
            .filter_map(|intent| Some((intent.name(), score.recalls.recall(intent)?)))
            .collect();
        let offsets: Vec<i32> = score.transitions.offsets().collect();
        serde_json::json!({
            "rule": rule,
            "event_rule": {"tolerance": TOLERANCE},
            "balanced_accuracy": score.recalls.balanced_accuracy(),
            "recalls": recalls,
            "gestures_recognised": own.recognised,
            "recognition": own.recognition,
            "decided": own.decided(),
            "rest_kept": own.rest_kept(),
            "decisions": own.decisions,
            "latency": own.latency,
            "release": own.release,
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
        })
    }

    /// Scores as text for a terminal, with a row for each change and gesture.
    pub fn tables(&self) -> String {
        let LabelScore {
            reference: score,
            emission,
            events,
            confusion,
            ..
        } = self;
        let share =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
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
        let decided =
            |own: (&String, &Tally)| format!("{} {} of {}", own.0, own.1.counted, own.1.all);
        if !own.decisions.is_empty() {
            let labels: Vec<String> = own.decisions.iter().map(decided).collect();
            text += &format!(
                "one decision         {}; rest kept {} ({})\n",
                share(own.decided()),
                share(own.rest_kept()),
                labels.join(", ")
            );
        }
        for (name, latency, from) in [
            ("latency", own.latency, "onset"),
            ("release", own.release, "end"),
        ] {
            if let Some(latency) = latency {
                text += &format!("{name:20} {} of the {from}\n", latency_in_words(latency));
            }
        }
        if own.gestures > 0 {
            let soon = SOON_MS.map(|ms| format!("{} in {ms} ms", share(own.recognised_within(ms))));
            text += &format!("so soon              {}\n", soon.join(", "));
        }
        text += &format!("false activations    {} of rest\n", per_minute(own.rest));
        if let Some(raised) = own.raised.values().copied().reduce(Tally::plus) {
            text += &format!(
                "other movements      {} of {} raise a label; {}\n",
                raised.counted,
                raised.all,
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
        if self.unscored > 0 {
            text += &format!(
                "not scored           the last {} samples, without a prediction\n",
                self.unscored
            );
        }
        if !transitions.changes.is_empty() {
            text += &format!("\n{}", changes(&transitions.changes).plain());
        }
        let mut reasons: BTreeMap<TransitionStatus, usize> = BTreeMap::new();
        for change in &transitions.changes {
            *reasons.entry(change.status).or_default() += 1;
        }
        reasons.remove(&TransitionStatus::Ok);
        for (status, count) in reasons {
            text += &format!("{count} x {}: {}\n", status.name(), status.reason());
        }
        if !events.gestures.is_empty() {
            text += &format!("\n{}", gestures(&events.gestures).plain());
        }
        text + "\n" + &matrix(confusion).plain()
    }
}

fn changes(changes: &[Change]) -> Table {
    let mut table = Table::new("", ["sample", "at s", "change", "status", "offset ms"]);
    for change in changes {
        table.push([
            change.at.to_string(),
            seconds(change.at),
            format!("{} -> {}", change.from.name(), change.to.name()),
            change.status.name().to_owned(),
            milliseconds(change.offset),
        ]);
    }
    table
}

fn gestures(gestures: &[Gesture]) -> Table {
    let columns = [
        "onset",
        "at s",
        "gesture",
        "verdict",
        "decision",
        "latency ms",
        "release ms",
    ];
    let mut table = Table::new("", columns);
    for gesture in gestures {
        let onset = gesture.span.start;
        table.push([
            onset.to_string(),
            seconds(onset),
            gesture.label.name().to_owned(),
            gesture.verdict.name().to_owned(),
            gesture.decision.map_or("", Intent::name).to_owned(),
            milliseconds(gesture.latency),
            milliseconds(gesture.release),
        ]);
    }
    table
}

fn seconds(sample: usize) -> String {
    format!("{:.2}", sample as f64 / f64::from(SAMPLE_RATE_HZ))
}

/// A number of samples in milliseconds, with its sign; empty without one.
fn milliseconds(samples: Option<i32>) -> String {
    samples.map_or_else(String::new, |samples| {
        format!("{:+}", i64::from(samples) * i64::from(SAMPLE_PERIOD_MS))
    })
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
