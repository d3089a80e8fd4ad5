//! Naive implementation of `score`, written from docs/metrics.md alone.

use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::Value;
use shared::intent::Intent;

use evaluation::metric::transition::Rule;

type Label = Option<Intent>;

const RELAX: Label = Some(Intent::Relax);
/// Constant T of docs/metrics.md, in samples.
const T: i64 = 50;

/// Numbers that docs/metrics.md defines.
#[derive(Debug, Default)]
pub(super) struct Expected {
    recalls: BTreeMap<&'static str, f64>,
    balanced: Option<f64>,
    raw: Option<f64>,
    /// Changes: sample, whether the prediction follows it, and its offset.
    changes: Vec<(i64, bool, Option<i64>)>,
    /// Gestures: onset, latency if it is recognised, and release latency if that is known.
    gestures: Vec<(i64, Option<i64>, Option<i64>)>,
    /// Decisions about the gestures of each label, and about rest spans: how many, and how many are right.
    decisions: BTreeMap<&'static str, (u64, u64)>,
    false_activations: usize,
    rest: usize,
    flicker: usize,
    labelled: usize,
}

impl Expected {
    fn decide(&mut self, label: &'static str, is_right: bool) {
        let (all, right) = self.decisions.entry(label).or_default();
        *all += 1;
        *right += u64::from(is_right);
    }
}

/// Scores of a prediction; none if the truth is refused.
pub(super) fn score(
    truth: &[Label],
    prediction: &[Label],
    rule: &Rule,
    delay: usize,
) -> Option<Expected> {
    let last = prediction.iter().rposition(Option::is_some);
    let scored = last.map_or(0, |last| last + 1);
    let (t, p) = (&truth[..scored], &prediction[..scored]);
    let emitted: Vec<Label> = (0..scored)
        .map(|at| at.checked_sub(delay).and_then(|place| p[place]))
        .collect();
    let mut expected = Expected {
        labelled: t.iter().flatten().count(),
        ..Expected::default()
    };
    samples(t, p, &mut expected);
    let mut owned = vec![false; scored];
    for stretch in stretches(t) {
        changes(t, p, &stretch, rule, &mut expected.changes)?;
        gestures(t, &emitted, &stretch, &mut owned, &mut expected);
        expected.flicker += flicker(t, &emitted, &stretch);
    }
    let at_rest = |at: usize| t[at] == RELAX && !owned[at];
    for at in 0..scored {
        if at_rest(at) && (at == 0 || !at_rest(at - 1)) {
            let end = (at..scored).find(|&to| !at_rest(to)).unwrap_or(scored);
            let raised = (at..end).any(|at| is_active(emitted[at]) && begins(&emitted, at));
            if end - at >= 200 {
                expected.decide("relax", !raised && !is_active(emitted[end - 1]));
            }
        }
        if at_rest(at) {
            expected.rest += 1;
            expected.false_activations +=
                usize::from(is_active(emitted[at]) && begins(&emitted, at));
        }
    }
    Some(expected)
}

/// Computes balanced and raw accuracy.
fn samples(t: &[Label], p: &[Label], expected: &mut Expected) {
    let right = |of: &dyn Fn(Label) -> bool| {
        let own = || t.iter().zip(p).filter(|(t, _)| of(**t));
        (own().filter(|(t, p)| t == p).count(), own().count())
    };
    for intent in Intent::ALL {
        let (correct, all) = right(&|label| label == Some(intent));
        if all > 0 {
            expected
                .recalls
                .insert(intent.name(), correct as f64 / all as f64);
        }
    }
    let recalls = &expected.recalls;
    expected.balanced =
        (recalls.len() > 1).then(|| recalls.values().sum::<f64>() / recalls.len() as f64);
    let (correct, all) = right(&|label| label.is_some());
    expected.raw = (all > 0).then(|| correct as f64 / all as f64);
}

fn stretches(t: &[Label]) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for (at, label) in t.iter().enumerate() {
        match found.last_mut() {
            _ if label.is_none() => {}
            Some(last) if last.end == at => last.end = at + 1,
            _ => found.push(at..at + 1),
        }
    }
    found
}

fn is_active(label: Label) -> bool {
    label.is_some() && label != RELAX
}

fn begins(labels: &[Label], at: usize) -> bool {
    at == 0 || labels[at - 1] != labels[at]
}

/// Finds the changes of one stretch; none if a label is too short for a buffer.
fn changes(
    t: &[Label],
    p: &[Label],
    stretch: &Range<usize>,
    rule: &Rule,
    found: &mut Vec<(i64, bool, Option<i64>)>,
) -> Option<()> {
    let (s, e) = (stretch.start as i64, stretch.end as i64);
    let h = (rule.buffer / 2) as i64;
    let at: Vec<i64> = (s + 1..e)
        .filter(|&k| t[k as usize] != t[k as usize - 1])
        .collect();
    let mut buffers: Vec<Range<i64>> = Vec::new();
    for (index, &k) in at.iter().enumerate() {
        let before = buffers.last().map_or(s, |buffer| buffer.end);
        let begin = (k - h).max(s).max(before);
        let mut end = (k + h).min(e);
        if let Some(&n) = at.get(index + 1)
            && n <= end
        {
            end = n - 1;
        }
        if begin >= k || end <= k {
            return None;
        }
        buffers.push(begin..end);
    }
    for (index, &k) in at.iter().enumerate() {
        let (a, b) = (t[k as usize - 1], t[k as usize]);
        let next = buffers.get(index + 1).map_or(e, |next| next.start);
        let of = |range: Range<i64>| range.map(|at| p[at as usize]).collect::<Vec<Label>>();
        let (near, later) = (of(buffers[index].clone()), of(buffers[index].end..next));
        let relax = |label: Label| rule.allow_relax && label == RELAX;
        let first = near.iter().position(|&label| label == b);
        let goes = if rule.strict {
            first.is_some_and(|first| {
                first > 0
                    && near[first..]
                        .iter()
                        .all(|&label| label == b || relax(label))
            })
        } else {
            (1..near.len()).any(|at| near[at - 1] == a && near[at] == b)
        };
        let needs_b = rule.allow_relax && !rule.strict && !later.is_empty();
        let is_followed = near
            .iter()
            .all(|&label| label == a || label == b || relax(label))
            && goes
            && later.iter().all(|&label| label == b || relax(label))
            && (!needs_b || later.contains(&b));
        let predicted = || {
            let mut nearest: Option<i64> = None;
            for at in (k - h).max(s + 1)..(k + h).min(e) {
                let straight = p[at as usize - 1] == a && p[at as usize] == b;
                if straight && nearest.is_none_or(|best| (at - k).abs() < (best - k).abs()) {
                    nearest = Some(at);
                }
            }
            let mut any = (k - h - 1).max(s)..(k + h - 1).min(e - 1);
            nearest.or_else(|| any.find(|&at| p[at as usize] == b).map(|at| at + 1))
        };
        let offset = is_followed.then(predicted).flatten().map(|at| 5 * (at - k));
        found.push((k, is_followed, offset));
    }
    Some(())
}

/// Scores the gestures of one stretch; marks the samples that belong to gestures.
fn gestures(
    t: &[Label],
    emitted: &[Label],
    stretch: &Range<usize>,
    owned: &mut [bool],
    expected: &mut Expected,
) {
    let (s, e) = (stretch.start as i64, stretch.end as i64);
    let onset =
        |at: i64| is_active(t[at as usize]) && (at == s || t[at as usize - 1] != t[at as usize]);
    let onsets: Vec<i64> = (s..e).filter(|&at| onset(at)).collect();
    for (index, &onset) in onsets.iter().enumerate() {
        let label = t[onset as usize];
        let end = (onset..e).find(|&at| t[at as usize] != label).unwrap_or(e);
        let next = onsets.get(index + 1).map_or(i64::MAX, |next| next - T);
        let own = (onset - T).max(s)..(end + T).min(e).min(next);
        for at in own.clone() {
            owned[at as usize] = true;
        }
        let is_counted = onset > s && (end < e || end - onset >= 200);
        if !is_counted {
            continue;
        }
        let (mut latency, mut release, mut other) = (None, None, false);
        for at in own.clone().filter(|&at| begins(emitted, at as usize)) {
            let begun = emitted[at as usize];
            other |= is_active(begun) && begun != label;
            let covers = (at..own.end).take_while(|&held| emitted[held as usize] == label);
            let held = covers.filter(|&held| held >= onset).count() as i64;
            if begun == label {
                let held = (at..e).take_while(|&held| emitted[held as usize] == label);
                release = held.last().map(|last| last + 1 - end);
            }
            if begun == label && 2 * held >= end - onset && latency.is_none() {
                latency = Some(at - onset);
            }
        }
        let latency = latency.filter(|_| !other);
        let is_followed = index + 1 < onsets.len() || e - end >= 4 * T;
        let release = release.filter(|&late| latency.is_some() && is_followed && late >= -T);
        expected.gestures.push((onset, latency, release));
        let samples = |intent: Intent| {
            let own = own
                .clone()
                .filter(|&at| emitted[at as usize] == Some(intent));
            own.count()
        };
        // The first of those with most samples: `max_by_key` takes the last.
        let most = Intent::ALL[1..]
            .iter()
            .rev()
            .max_by_key(|&&own| samples(own));
        let decision = most.copied().filter(|&own| samples(own) > 0);
        expected.decide(label.map_or("", Intent::name), decision == label);
    }
}

fn flicker(t: &[Label], emitted: &[Label], stretch: &Range<usize>) -> usize {
    let first = emitted.iter().position(Option::is_some);
    let (s, e) = (stretch.start as i64, stretch.end as i64);
    let mut cuts: Vec<i64> = (s + 1..e)
        .filter(|&at| t[at as usize] != t[at as usize - 1])
        .map(|at| (at - T).max(s))
        .collect();
    cuts.push(e);
    let mut count = 0;
    let mut part = s;
    let mut allowed = usize::from(s > 0);
    for cut in cuts {
        let changes = (part..cut).filter(|&at| {
            at > 0 && Some(at as usize) != first && emitted[at as usize] != emitted[at as usize - 1]
        });
        count += changes.count().saturating_sub(allowed);
        (part, allowed) = (cut, 1);
    }
    count
}

/// Quantile of the latencies of `of` gestures, in ms; `None` if it falls on a missed gesture.
fn quantile(latencies: impl Iterator<Item = i64>, of: usize, percent: usize) -> Option<i64> {
    let mut latencies: Vec<i64> = latencies.collect();
    latencies.sort_unstable();
    let rank = (percent * of).div_ceil(100);
    latencies.get(rank - 1).map(|samples| 5 * samples)
}

/// Compares the JSON of `score` with what is expected.
pub(super) fn compare(found: &Value, expected: &Expected, round: usize) {
    let number = |value: &Value, expected: Option<f64>, what: &str| {
        let equal = match (value.as_f64(), expected) {
            (Some(found), Some(expected)) => (found - expected).abs() < 1e-9,
            (found, expected) => found.is_none() && expected.is_none(),
        };
        assert!(equal, "{round}, {what}: {value}, expected {expected:?}");
    };
    number(
        &found["balanced_accuracy"],
        expected.balanced,
        "balanced accuracy",
    );
    number(&found["raw_accuracy"], expected.raw, "raw accuracy");
    assert_eq!(
        found["recalls"].as_object().unwrap().len(),
        expected.recalls.len()
    );
    for (name, recall) in &expected.recalls {
        number(&found["recalls"][name], Some(*recall), name);
    }
    let changes: Vec<_> = found["changes"].as_array().unwrap().iter().collect();
    let told: Vec<_> = changes
        .iter()
        .map(|own| {
            let offset = own["offset"].as_i64().map(|samples| 5 * samples);
            (own["at"].as_i64().unwrap(), own["status"] == "ok", offset)
        })
        .collect();
    assert_eq!(told, expected.changes, "{round}");
    let followed = expected.changes.iter().filter(|own| own.1).count();
    let share = |part: usize, of: usize| (of > 0).then(|| part as f64 / of as f64);
    let accuracy = share(followed, expected.changes.len());
    number(
        &found["transition_accuracy"],
        accuracy,
        "transition accuracy",
    );
    let offsets: Vec<f64> = expected
        .changes
        .iter()
        .filter_map(|own| own.2)
        .map(|ms| ms as f64)
        .collect();
    let mean = |all: &[f64]| (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
    let absolute: Vec<f64> = offsets.iter().map(|ms| ms.abs()).collect();
    number(
        &found["offset_ms"]["signed"]["mean"],
        mean(&offsets),
        "offset",
    );
    number(
        &found["offset_ms"]["absolute"]["mean"],
        mean(&absolute),
        "absolute offset",
    );

    let gestures: Vec<_> = found["gestures"].as_array().unwrap().iter().collect();
    let told: Vec<_> = gestures
        .iter()
        .map(|own| {
            (
                own["span"]["start"].as_i64().unwrap(),
                own["latency"].as_i64(),
                own["release"].as_i64(),
            )
        })
        .collect();
    assert_eq!(told, expected.gestures, "{round}");
    let recognised = expected
        .gestures
        .iter()
        .filter(|own| own.1.is_some())
        .count();
    number(
        &found["recognition"],
        share(recognised, told.len()),
        "gestures recognised",
    );
    if !told.is_empty() {
        for (name, percent) in [("median", 50), ("p90", 90)] {
            let latency = &found["latency"][name];
            let latencies = expected.gestures.iter().filter_map(|own| own.1);
            match quantile(latencies, told.len(), percent) {
                Some(ms) => number(&latency["ms"], Some(ms as f64), name),
                None => assert_eq!(latency, "missed", "{round}"),
            }
            let releases = || expected.gestures.iter().filter_map(|own| own.2);
            let release =
                (releases().count() > 0).then(|| quantile(releases(), releases().count(), percent));
            let release = release.flatten().map(|ms| ms as f64);
            number(&found["release"][name]["ms"], release, "release");
        }
    }
    let told = found["decisions"].as_object().unwrap().iter();
    let told = told.map(|(name, own)| {
        let [all, right] = ["all", "counted"].map(|part| own[part].as_u64().unwrap());
        (&name[..], (all, right))
    });
    assert_eq!(
        told.collect::<BTreeMap<_, _>>(),
        expected.decisions,
        "{round}"
    );
    let ratio = |own: &(u64, u64)| own.1 as f64 / own.0 as f64;
    let labels = expected.decisions.iter().filter(|own| *own.0 != "relax");
    let labels: Vec<f64> = labels.map(|(_, own)| ratio(own)).collect();
    number(&found["decided"], mean(&labels), "one decision");
    let kept = expected.decisions.get("relax").map(ratio);
    number(&found["rest_kept"], kept, "rest kept");
    for (name, count, samples) in [
        (
            "false_activations",
            expected.false_activations,
            expected.rest,
        ),
        ("flicker", expected.flicker, expected.labelled),
    ] {
        let seconds = samples as f64 / 200.0;
        number(&found[name]["count"], Some(count as f64), name);
        number(&found[name]["seconds"], Some(seconds), name);
        number(
            &found[name]["per_minute"],
            (samples > 0).then(|| 60.0 * count as f64 / seconds),
            name,
        );
    }
}
