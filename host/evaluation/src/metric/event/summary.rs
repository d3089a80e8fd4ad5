//! Events of many recordings: per subject, then over subjects.
//!
//! Per subject: the gestures, times and counts of all recordings together. Over subjects: the latencies of all gestures;
//! means are those of a [`Measure`](crate::Measure).

use std::collections::BTreeMap;

use super::RecordingEvents;
use super::activation::{DailyUse, Rate};
use super::latency::{self, LatencySummary};
use recordings::statistics::MeanSd;
use shared::intent::Intent;
use shared::units::SAMPLE_PERIOD_MS;

/// Number of gestures, rest spans or movements, and of those that count.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Tally {
    /// Number of all.
    pub all: usize,
    /// Number of those whose decision is right, or that raise a label.
    pub counted: usize,
}

impl Tally {
    /// Sum of both.
    pub const fn plus(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            counted: self.counted + other.counted,
        }
    }

    /// A single one.
    pub const fn one(counts: bool) -> Self {
        Self {
            all: 1,
            counted: counts as usize,
        }
    }

    /// Share of those that count; `None` without any.
    pub fn share(self) -> Option<f64> {
        (self.all > 0).then(|| self.counted as f64 / self.all as f64)
    }
}

/// The events of one subject.
#[derive(Clone, PartialEq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct SubjectEvents {
    /// Subject.
    pub subject: String,
    /// Gestures in the truth.
    pub gestures: usize,
    /// Gestures that are recognised.
    pub recognised: usize,
    /// `recognised / gestures`; none without a gesture.
    pub recognition: Option<f64>,
    /// Decisions about gestures, by the name of their label, and about rest spans, by `relax`; empty in scores of earlier
    /// versions.
    #[serde(default)]
    pub decisions: BTreeMap<String, Tally>,
    /// Latency of each gesture that is recognised, in samples.
    pub latencies: Vec<i32>,
    /// Quantiles of the latency, misses included.
    pub latency: Option<LatencySummary>,
    /// Release latency of each recognised gesture whose release is known, in samples; empty in scores of earlier versions.
    #[serde(default)]
    pub releases: Vec<i32>,
    /// Quantiles of the release latency.
    #[serde(default)]
    pub release: Option<LatencySummary>,
    /// False activations in rest.
    pub rest: Rate,
    /// Activations in movements outside the vocabulary.
    pub other_movement: Rate,
    /// Numbers of these movements, all and raising a label, by the name of their kind; empty in scores of
    /// earlier versions.
    #[serde(default)]
    pub raised: BTreeMap<String, Tally>,
    /// Daily life, by the name of its kind; empty in scores of earlier versions.
    #[serde(default)]
    pub daily: BTreeMap<String, DailyUse>,
    /// Label changes beyond the true ones.
    pub flicker: Rate,
}

impl SubjectEvents {
    /// The events of a subject's recordings together.
    pub fn new<'a>(
        subject: &str,
        recordings: impl IntoIterator<Item = &'a RecordingEvents>,
    ) -> Self {
        let mut own = Self {
            subject: subject.to_owned(),
            ..Self::default()
        };
        for recording in recordings {
            own.gestures += recording.gestures.len();
            own.recognised += recording.recognised();
            let latencies = recording.gestures.iter().filter_map(|g| g.latency);
            own.latencies.extend(latencies);
            let releases = recording.gestures.iter().filter_map(|g| g.release);
            own.releases.extend(releases);
            let gestures = recording.gestures.iter();
            let decided = gestures.map(|g| (g.label, Tally::one(g.decision == Some(g.label))));
            let rests = Some((Intent::Relax, recording.rests)).filter(|(_, own)| own.all > 0);
            for (label, decisions) in decided.chain(rests) {
                let all = own.decisions.entry(label.name().to_owned()).or_default();
                *all = all.plus(decisions);
            }
            own.rest = own.rest.plus(recording.rest);
            own.other_movement = own.other_movement.plus(recording.other_movement);
            own.flicker = own.flicker.plus(recording.flicker);
            for (kind, part) in &recording.daily {
                let kind = own.daily.entry(kind.name().to_owned()).or_default();
                *kind = kind.plus(*part);
            }
            for (kind, raised) in &recording.raised {
                let kind = own.raised.entry(kind.name().to_owned()).or_default();
                *kind = kind.plus(Tally::one(*raised));
            }
        }
        own.recognition = (own.gestures > 0).then(|| own.recognised as f64 / own.gestures as f64);
        own.latency = latency::summary(&own.latencies, own.gestures);
        own.release = latency::summary(&own.releases, own.releases.len());
        own
    }

    /// Share of the gestures that are recognised within these milliseconds after their onset; none without a gesture.
    pub fn recognised_within(&self, ms: u32) -> Option<f64> {
        let samples = (ms / SAMPLE_PERIOD_MS) as i32;
        let soon = self.latencies.iter().filter(|&&late| late <= samples);
        (self.gestures > 0).then(|| soon.count() as f64 / self.gestures as f64)
    }

    /// Share of gestures whose one decision is right, mean over their labels; none without a gesture.
    pub fn decided(&self) -> Option<f64> {
        let labels = self.decisions.iter();
        let labels = labels.filter(|(name, _)| *name != Intent::Relax.name());
        let shares: Vec<f64> = labels.filter_map(|(_, own)| own.share()).collect();
        MeanSd::of(&shares).map(|of| of.mean)
    }

    /// Share of rest spans that stay at rest; none without any.
    pub fn rest_kept(&self) -> Option<f64> {
        self.decisions.get(Intent::Relax.name())?.share()
    }

    /// All daily life together; none without any.
    pub fn daily_life(&self) -> Option<DailyUse> {
        self.daily.values().copied().reduce(DailyUse::plus)
    }

    /// Share of the movements outside the vocabulary that raise a label; none without any.
    pub fn raised_share(&self) -> Option<f64> {
        let all = self.raised.values().copied();
        all.fold(Tally::default(), Tally::plus).share()
    }
}

/// The events of all subjects.
#[derive(Clone, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct EventSummary {
    /// Each subject, in alphabetical order.
    pub subjects: Vec<SubjectEvents>,
    /// Gestures of all subjects.
    pub gestures: usize,
    /// Gestures that are recognised, of all subjects.
    pub recognised: usize,
    /// Quantiles of the latency over all gestures, misses included.
    pub latency: Option<LatencySummary>,
    /// Quantiles of the release latency over all gestures whose release is known; none in scores of earlier versions.
    #[serde(default)]
    pub release: Option<LatencySummary>,
}

impl EventSummary {
    /// Summary of the events of subjects, each given once, in any order.
    pub fn of_subjects(mut subjects: Vec<SubjectEvents>) -> Self {
        subjects.sort_by(|a, b| a.subject.cmp(&b.subject));
        let latencies: Vec<i32> = subjects.iter().flat_map(|s| s.latencies.clone()).collect();
        let releases: Vec<i32> = subjects.iter().flat_map(|s| s.releases.clone()).collect();
        let gestures = subjects.iter().map(|s| s.gestures).sum();
        Self {
            gestures,
            recognised: subjects.iter().map(|s| s.recognised).sum(),
            latency: latency::summary(&latencies, gestures),
            release: latency::summary(&releases, releases.len()),
            subjects,
        }
    }
}
