//! Gestures, and whether each is recognised.
//!
//! A gesture is a run of one active label A (any but relax) in the truth, `onset..end`, whose onset is in the
//! recording: the sample before it is labelled. It owns the samples from `tolerance` before its onset until
//! `tolerance` after its end, or until `tolerance` before the onset of the next one, or until the truth becomes unknown.
//! A gesture that the end of the labels cuts to less than four times the tolerance is not counted.
//!
//! It is recognised if among its samples
//! * a run of emitted labels A begins and is held: without an interruption it covers, from the onset on and within the
//!   gesture's own samples, at least half as many samples as the gesture lasts; and
//! * no run of another active label begins.
//!
//! A label that was there before and stays does not count: the user sees no reaction to the gesture.
//! Nor is a label that comes by chance somewhere in a long gesture.
//! Latency = first sample of the run that is held - onset; negative within the tolerance before the onset.
//!
//! Release latency = end of the last run of A that begins among its samples - end of the gesture. It is known of a
//! recognised gesture that another one follows in the labelled stretch, or at least four times the tolerance of labels.
//! A label that is still there at the end of the stretch counts as let go there. One that falls more than the tolerance
//! before the end of the gesture does not count.

use std::ops::Range;

use shared::intent::Intent;

use super::decision::decision;
use super::{TOLERANCE, active};
use crate::metric::{by_name, stretches};
use recordings::runs;

/// A gesture of the truth. All positions are samples of the recording.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Gesture {
    /// Label of the gesture.
    #[serde(serialize_with = "by_name")]
    pub label: Intent,
    /// Samples from its onset to its end.
    pub span: Range<usize>,
    /// The one decision about it: the label emitted at most of its samples, if any.
    #[serde(serialize_with = "by_name_if_any")]
    pub decision: Option<Intent>,
    /// Whether it is recognised, or why not.
    pub verdict: Verdict,
    /// Emission of its label minus onset, in samples, if it is recognised.
    pub latency: Option<i32>,
    /// Emission of the change away from its label minus end, in samples, if it is recognised and its release known.
    pub release: Option<i32>,
}

shared::names! {
    /// Whether a gesture is recognised, or why not.
    #[derive(PartialOrd, Ord, serde::Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Verdict {
        /// The gesture is recognised.
        Recognised = "recognised",
        /// Another active label began.
        OtherLabel = "another gesture's label was emitted",
        /// The gesture's label began and was not held.
        NotHeld = "its label was emitted and not held",
        /// The gesture's label did not begin.
        NoLabel = "its label was not emitted",
    }
}

/// A gesture of the truth and the samples that it owns.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Owner {
    label: Intent,
    span: Range<usize>,
    pub(super) samples: Range<usize>,
    /// Whether it is counted: its onset is in the recording and enough of it too.
    counted: bool,
    /// End of its labelled stretch, if its release is in it.
    released_by: Option<usize>,
}

/// The runs of active labels in the truth, in order, with the samples that they own; these do not overlap.
pub(super) fn owners(truth: &[Option<Intent>]) -> Vec<Owner> {
    let mut owners: Vec<Owner> = Vec::new();
    for stretch in stretches(truth) {
        let first = owners.len();
        for run in runs(&truth[stretch.clone()]) {
            let Some(label) = active(run.label) else {
                continue;
            };
            let span = stretch.start + run.start..stretch.start + run.end;
            let from = span.start.saturating_sub(TOLERANCE);
            let cut = span.end == stretch.end && span.len() < 4 * TOLERANCE;
            if let Some(before) = owners[first..].last_mut() {
                before.samples.end = before.samples.end.min(from.max(before.samples.start));
                before.released_by = Some(stretch.end);
            }
            let rests = stretch.end - span.end >= 4 * TOLERANCE;
            owners.push(Owner {
                label,
                samples: from.max(stretch.start)..(span.end + TOLERANCE).min(stretch.end),
                counted: span.start > stretch.start && !cut,
                released_by: rests.then_some(stretch.end),
                span,
            });
        }
    }
    owners
}

/// The gestures of the truth, judged by the labels emitted.
///
/// Both sequences have one length.
pub fn gestures(truth: &[Option<Intent>], emitted: &[Option<Intent>]) -> Vec<Gesture> {
    let emitted_runs: Vec<_> = runs(emitted)
        .into_iter()
        .filter_map(|run| Some((active(run.label)?, run.start..run.end)))
        .collect();
    owners(truth)
        .into_iter()
        .filter(|owner| owner.counted)
        .map(|owner| {
            let decision = decision(&emitted[owner.samples.clone()]);
            judge(owner, decision, &emitted_runs)
        })
        .collect()
}

fn judge(owner: Owner, decision: Option<Intent>, emitted: &[(Intent, Range<usize>)]) -> Gesture {
    let Owner {
        label,
        span,
        samples,
        released_by,
        ..
    } = owner;
    let begun = || {
        emitted
            .iter()
            .filter(|(_, run)| samples.contains(&run.start))
    };
    let held = |run: &Range<usize>| {
        let covered = run.end.min(samples.end);
        2 * covered.saturating_sub(run.start.max(span.start)) >= span.len()
    };
    let first = begun().find(|(own, run)| *own == label && held(run));
    let verdict = if begun().any(|(other, _)| *other != label) {
        Verdict::OtherLabel
    } else if first.is_some() {
        Verdict::Recognised
    } else if begun().next().is_some() {
        Verdict::NotHeld
    } else {
        Verdict::NoLabel
    };
    let recognised = verdict == Verdict::Recognised;
    let latency = first
        .filter(|_| recognised)
        .map(|(_, run)| run.start as i32 - span.start as i32);
    let last = begun().rfind(|(own, _)| *own == label);
    let release = last.zip(released_by).filter(|_| recognised);
    let release = release.map(|((_, run), by)| run.end.min(by) as i32 - span.end as i32);
    Gesture {
        label,
        span,
        decision,
        verdict,
        latency,
        release: release.filter(|&samples| samples >= -(TOLERANCE as i32)),
    }
}

fn by_name_if_any<S: serde::Serializer>(
    intent: &Option<Intent>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&intent.map(Intent::name), serializer)
}
