//! Scores of a model on subjects that it was not trained on, under every condition.

use std::collections::BTreeMap;

use rayon::prelude::*;
use recordings::statistics::MeanSd;
use serde::{Deserialize, Serialize, Serializer};
use shared::intent::{Intent, Vocabulary};

use super::candidate::Candidate;
use super::condition::{LookAhead, Truth};
use super::evaluated_recording::EvaluatedRecording;
use super::group::{Group, groups};
use super::measure::Measure;
use super::metric::confusion::Confusion;
use super::metric::event::summary::{EventSummary, SubjectEvents};
use super::metric::event::{
    RecordingEvents,
    gesture::{self, Gesture},
};
use super::metric::summary::{RecordingScore, Summary, summary};
use super::metric::transition::Rule;
use super::smoothing::SmoothedLabels;
use super::system::System;
use crate::EvaluationError;

/// Widths of the buffer around a transition, in samples (paper: 200; ablation: 60 and 120).
pub const BUFFERS: [usize; 3] = [60, 120, 200];

/// [`Score::data_set`] of the scores over all data sets.
pub const ALL: &str = "all";

/// One row of results: one model under one condition, on one group of people of one data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The system; JSON has its name.
    pub model: System,
    /// Name of the data set, or [`ALL`].
    pub data_set: String,
    /// Number of classes of the model.
    pub classes: usize,
    /// Group of the people.
    pub people: Group,
    /// Look-ahead and aggregation mode.
    pub look_ahead: LookAhead,
    /// Labels that predictions were compared with.
    pub truth: Truth,
    /// Scores with each buffer of [`BUFFERS`], each label at its reference time; JSON has the `buffer` beside each.
    #[serde(serialize_with = "with_buffers")]
    pub reference: [Summary; BUFFERS.len()],
    /// Scores with the widest buffer, each label at its emission time; without people in results of earlier versions.
    #[serde(default)]
    pub emission: Summary,
    /// Events, each label at its emission time.
    pub events: EventSummary,
    /// Mean over people of each [`Measure`] that anybody has a value of, by its name; empty in results of earlier versions.
    #[serde(default)]
    pub means: BTreeMap<String, MeanSd>,
}

impl Score {
    /// The paper's score: the widest buffer, each label at its reference time.
    pub const fn widest(&self) -> &Summary {
        &self.reference[BUFFERS.len() - 1]
    }

    /// Share of gestures recognised within `ms` milliseconds after their onset, of each person who makes gestures, in
    /// alphabetical order.
    pub fn recognised_within(&self, ms: u32) -> Vec<(&str, f64)> {
        let people = self.events.subjects.iter();
        people
            .filter_map(|own| Some((own.subject.as_str(), own.recognised_within(ms)?)))
            .collect()
    }

    fn with_means(mut self) -> Self {
        let mean = |measure: Measure| Some((measure.name().to_owned(), measure.mean(&self)?));
        self.means = Measure::ALL.into_iter().filter_map(mean).collect();
        self
    }

    pub(crate) fn people_name(&self) -> String {
        self.people.name(self.classes)
    }

    /// Whether two rows are of the same people, as far as data set and group tell.
    pub(crate) fn same_people(&self, other: &Self) -> bool {
        (&self.data_set, self.people) == (&other.data_set, other.people)
    }
}

/// A summary with the buffer that it is for.
#[derive(Serialize)]
struct Buffered<'a> {
    buffer: usize,
    #[serde(flatten)]
    summary: &'a Summary,
}

fn with_buffers<S: Serializer>(
    reference: &[Summary; BUFFERS.len()],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let pairs = BUFFERS.into_iter().zip(reference);
    serializer.collect_seq(pairs.map(|(buffer, summary)| Buffered { buffer, summary }))
}

/// Rows of [`score`] for every candidate under each condition that it allows, against each truth.
pub fn score_all(
    candidates: &[Candidate],
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    truths: &[Truth],
) -> Result<Vec<Score>, EvaluationError> {
    let mut scores = Vec::new();
    if recordings.is_empty() {
        return Ok(scores);
    }
    for &truth in truths {
        for candidate in candidates {
            for look_ahead in candidate.conditions() {
                let labels = labels(candidate, recordings, vocabulary, look_ahead)?;
                let model = &candidate.model;
                scores.extend(rows(
                    model, &labels, recordings, vocabulary, look_ahead, truth,
                )?);
            }
        }
    }
    Ok(scores)
}

/// Scores a candidate under one condition: a row for each data set among the recordings, and one over all of them if
/// there are several; each for the people of either [`Group`], if there are any. True labels are lag-compensated.
pub fn score(
    candidate: &Candidate,
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Vec<Score>, EvaluationError> {
    let labels = labels(candidate, recordings, vocabulary, look_ahead)?;
    score_labels(
        &candidate.model,
        &labels,
        recordings,
        vocabulary,
        look_ahead,
    )
}

fn labels(
    candidate: &Candidate,
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Vec<SmoothedLabels>, EvaluationError> {
    let numbered = recordings.par_iter().enumerate();
    let labels =
        numbered.map(|(at, recording)| candidate.labels(at, recording, vocabulary, look_ahead));
    Ok(labels.collect::<Result<_, _>>()?)
}

/// Scores the labels of a model or of any program, in the order of the recordings, by lag-compensated true labels: rows as of [`score`].
pub fn score_labels(
    model: &System,
    labels: &[SmoothedLabels],
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Vec<Score>, EvaluationError> {
    let truth = Truth::LagCompensated;
    rows(model, labels, recordings, vocabulary, look_ahead, truth)
}

/// Rows of a condition by either kind of true labels.
fn rows(
    model: &System,
    labels: &[SmoothedLabels],
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
    truth: Truth,
) -> Result<Vec<Score>, EvaluationError> {
    let scored: Vec<_> = recordings
        .par_iter()
        .zip(labels)
        .filter_map(|(recording, labels)| {
            let truth = match truth {
                Truth::Published => recording.published.as_ref()?,
                Truth::LagCompensated => &recording.lag_compensated,
            };
            let scores = score_recording(recording, labels, truth);
            Some(scores.map(|scores| (recording, scores)))
        })
        .collect::<Result<_, _>>()?;
    let mut sets: Vec<&'static str> = scored
        .iter()
        .map(|(recording, _)| recording.data_set.name())
        .collect();
    sets.sort_unstable();
    sets.dedup();
    if sets.len() != 1 {
        sets.push(ALL);
    }
    let everybody = summary(scored.iter().map(|(_, scores)| &scores.reference[0]));
    let groups = groups(&everybody.subjects, vocabulary.classes());
    let row = |(set, people): (&'static str, Group)| {
        let own: Vec<_> = scored
            .iter()
            .filter(|(recording, _)| set == ALL || recording.data_set.name() == set)
            .filter(|(recording, _)| groups[&recording.subject[..]] == people)
            .collect();
        // Only a result without any people has a row without people.
        if own.is_empty() && !(scored.is_empty() && people == Group::AllClasses) {
            return None;
        }
        let reference = |index: usize| summary(own.iter().map(|(_, of)| &of.reference[index]));
        let mut by_subject: BTreeMap<&str, Vec<&RecordingEvents>> = BTreeMap::new();
        for (recording, scores) in &own {
            let events = by_subject.entry(&recording.subject).or_default();
            events.push(&scores.events);
        }
        let subjects = by_subject
            .into_iter()
            .map(|(subject, events)| SubjectEvents::new(subject, events));
        let score = Score {
            model: model.clone(),
            data_set: set.to_owned(),
            classes: vocabulary.classes(),
            people,
            look_ahead,
            truth,
            reference: std::array::from_fn(reference),
            emission: summary(own.iter().map(|(_, of)| &of.emission)),
            events: EventSummary::of_subjects(subjects.collect()),
            means: BTreeMap::new(),
        };
        Some(score.with_means())
    };
    let both = |&set: &&'static str| Group::ALL.map(|people| (set, people));
    Ok(sets.iter().flat_map(both).filter_map(row).collect())
}

struct RecordingScores {
    /// Scores at reference times, with each buffer.
    reference: [RecordingScore; BUFFERS.len()],
    /// Scores at emission times, with the widest buffer.
    emission: RecordingScore,
    /// Events at emission times.
    events: RecordingEvents,
}

fn score_recording(
    recording: &EvaluatedRecording,
    labels: &SmoothedLabels,
    truth: &[Option<Intent>],
) -> Result<RecordingScores, EvaluationError> {
    let SmoothedLabels { reference, emitted } = labels;
    let with_buffer = |labels: &[Option<Intent>], buffer| {
        // Samples before the first label are not scored, nor, as in the reference, samples after the last one.
        let first = labels.iter().position(Option::is_some).unwrap_or(0);
        let rule = Rule {
            buffer,
            ..Rule::default()
        };
        let (truth, labels) = (&truth[first..], &labels[first..]);
        RecordingScore::new(&recording.subject, truth, labels, &rule)
    };
    let [narrow, middle, wide] = BUFFERS;
    Ok(RecordingScores {
        reference: [
            with_buffer(reference, narrow)?,
            with_buffer(reference, middle)?,
            with_buffer(reference, wide)?,
        ],
        emission: with_buffer(emitted, wide)?,
        events: RecordingEvents::new(truth, emitted, &recording.other_movement)?,
    })
}

/// The gestures of all recordings, judged by the labels that a candidate emits: lag-compensated labels.
pub fn gestures(
    candidate: &Candidate,
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Vec<Gesture>, EvaluationError> {
    let labels = labels(candidate, recordings, vocabulary, look_ahead)?;
    let judged = recordings.iter().zip(labels);
    let judged =
        judged.flat_map(|(own, labels)| gesture::gestures(&own.lag_compensated, &labels.emitted));
    Ok(judged.collect())
}

/// Confusion matrix of a candidate over all recordings: lag-compensated labels, each predicted label at its reference
/// time.
pub fn confusion(
    candidate: &Candidate,
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Confusion, EvaluationError> {
    let mut confusion = Confusion::new(vocabulary);
    let labels = labels(candidate, recordings, vocabulary, look_ahead)?;
    for (recording, labels) in recordings.iter().zip(labels) {
        confusion.add(&recording.lag_compensated, &labels.reference)?;
    }
    Ok(confusion)
}

#[cfg(any(test, feature = "testing"))]
impl Score {
    /// Score of a three-class model `m` over people of data set `x` with all classes, for tests of code that reads
    /// scores.
    pub fn of_people(
        subjects: Vec<crate::metric::summary::SubjectScore>,
        events: Vec<SubjectEvents>,
    ) -> Self {
        let summary = Summary::of_subjects(subjects);
        let score = Self {
            model: "m".into(),
            data_set: "x".to_owned(),
            classes: 3,
            people: Group::AllClasses,
            look_ahead: LookAhead::None,
            truth: Truth::LagCompensated,
            reference: std::array::from_fn(|_| summary.clone()),
            emission: summary.clone(),
            events: EventSummary::of_subjects(events),
            means: BTreeMap::new(),
        };
        score.with_means()
    }
}

#[cfg(test)]
mod tests;
