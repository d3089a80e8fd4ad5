//! Every model, every condition, one table: what each says about people whom none has seen.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use shared::intent::{Intent, Vocabulary};
use shared::stream::smoother::{AggregationMode, Settings};
use thiserror::Error;

use super::track::{Track, track};
use super::trial::Trial;
use crate::evaluation::metric::MetricError;
use crate::evaluation::metric::confusion::Confusion;
use crate::evaluation::metric::summary::{RecordingScore, Summary, summary};
use crate::evaluation::metric::transition::Rule;
use shared::model::LookBackLogits;

/// Widths of the buffer around a transition, in samples (paper: 200; ablation: 60 and 120).
pub const BUFFERS: [usize; 3] = [60, 120, 200];

/// What the labels are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Truth {
    /// Labels as published: the cues, as the paper scores.
    Published,
    /// Lag-compensated labels: moved by one constant a data set, to where muscle activity begins.
    LagCompensated,
}

/// How rows become labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LookAhead {
    /// The newest row alone.
    None,
    /// 0.25 s, every row from the instant on.
    AllRows,
    /// 0.25 s, the instant's own rows.
    SameInstant,
}

impl LookAhead {
    /// All three.
    pub const ALL: [Self; 3] = [Self::None, Self::AllRows, Self::SameInstant];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "0",
            Self::AllRows => "0.25 s, all rows",
            Self::SameInstant => "0.25 s, same instant",
        }
    }

    /// The smoother's settings; labels hold for 0.1 s in all of them.
    #[must_use]
    pub const fn settings(self) -> Settings {
        let paper = Settings::PAPER_IN_PATCHES;
        match self {
            Self::None => Settings {
                look_ahead: 0,
                ..paper
            },
            Self::AllRows => Settings {
                aggregation: AggregationMode::AllRowsFrom,
                ..paper
            },
            Self::SameInstant => Settings {
                aggregation: AggregationMode::SameInstant,
                ..paper
            },
        }
    }
}

/// One model's word on every trial.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name in tables.
    pub name: String,
    /// Whether its rows speak of past patches too; if not, there is nothing to look ahead with.
    pub looks_back: bool,
    /// Logits of each trial's patches, in the order of the trials.
    pub logits: Vec<Vec<LookBackLogits>>,
}

impl Candidate {
    /// The conditions that it can be judged under.
    pub fn conditions(&self) -> impl Iterator<Item = LookAhead> {
        LookAhead::ALL
            .into_iter()
            .filter(|&look_ahead| self.looks_back || look_ahead == LookAhead::None)
    }

    /// A wanted condition, or none of it where there is nothing to look ahead with.
    #[must_use]
    pub fn condition(&self, wanted: LookAhead) -> LookAhead {
        if self.looks_back {
            wanted
        } else {
            LookAhead::None
        }
    }
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Which model.
    pub model: String,
    /// Which recordings: a data set's name or `all`.
    pub data_set: String,
    /// How rows became labels.
    pub look_ahead: LookAhead,
    /// What the labels were compared with.
    pub truth: Truth,
    /// Scores with each buffer of [`BUFFERS`], labels booked at the instant reference of.
    pub reference: [Summary; BUFFERS.len()],
    /// Scores with the widest buffer, labels booked when emitted.
    pub emitted: Summary,
}

impl Score {
    /// Scores with the widest buffer, the paper's, booked at the instant reference of.
    #[must_use]
    pub const fn widest(&self) -> &Summary {
        &self.reference[BUFFERS.len() - 1]
    }
}

/// Why candidates cannot be judged.
#[derive(Debug, Error)]
pub enum JudgeError {
    /// A metric refuses its sequences.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The smoother refuses its settings.
    #[error(transparent)]
    Smoother(#[from] shared::stream::smoother::SettingsError),
}

/// Judges a candidate under one condition, over all trials and for each data set among them.
///
/// # Errors
/// When a metric or the smoother refuses.
pub fn judge(
    candidate: &Candidate,
    trials: &[Trial],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
    truth: Truth,
) -> Result<Vec<Score>, JudgeError> {
    let scored: Vec<_> = trials
        .par_iter()
        .zip(&candidate.logits)
        .filter_map(|(trial, rows)| {
            let labels = match truth {
                Truth::Published => trial.published.as_ref()?,
                Truth::LagCompensated => &trial.lag_compensated,
            };
            Some(
                score(trial, rows, labels, vocabulary, look_ahead.settings())
                    .map(|scores| (trial.data_set.name(), scores)),
            )
        })
        .collect::<Result<_, _>>()?;
    let mut sets: Vec<&str> = scored.iter().map(|(set, _)| *set).collect();
    sets.sort_unstable();
    sets.dedup();
    if sets.len() != 1 {
        sets.push(ALL);
    }
    let score = |set: &str| {
        let chosen = || {
            scored
                .iter()
                .filter(move |(own, _)| set == ALL || *own == set)
        };
        let of = |book: usize| {
            summary(
                &chosen()
                    .map(|(_, scores)| scores[book].clone())
                    .collect::<Vec<_>>(),
            )
        };
        Score {
            model: candidate.name.clone(),
            data_set: set.to_owned(),
            look_ahead,
            truth,
            reference: std::array::from_fn(of),
            emitted: of(BUFFERS.len()),
        }
    };
    Ok(sets.into_iter().map(score).collect())
}

/// Name of the line over all data sets.
pub const ALL: &str = "all";

/// Scores of one trial: reference book with each buffer, then the emitted book with the widest.
fn score(
    trial: &Trial,
    rows: &[LookBackLogits],
    labels: &[Option<Intent>],
    vocabulary: Vocabulary,
    settings: Settings,
) -> Result<Vec<RecordingScore>, JudgeError> {
    let Track { reference, emitted } =
        track(rows, trial.emg.len(), vocabulary.classes(), settings)?;
    // Like the reference at a recording's end, its start is judged only once there is a label.
    let first = reference.iter().position(Option::is_some).unwrap_or(0);
    let rule = |buffer| Rule {
        buffer,
        ..Rule::default()
    };
    let score = |book: &[Option<Intent>], buffer| {
        RecordingScore::new(
            &trial.subject,
            &trial.name,
            &labels[first..],
            &book[first..],
            &rule(buffer),
        )
    };
    let mut scores = Vec::with_capacity(BUFFERS.len() + 1);
    for buffer in BUFFERS {
        scores.push(score(&reference, buffer)?);
    }
    scores.push(score(&emitted, BUFFERS[BUFFERS.len() - 1])?);
    Ok(scores)
}

/// Offsets of the changes that a candidate follows within the widest buffer, in samples, labels
/// moved and booked at the instant they speak of.
///
/// # Errors
/// When a metric or the smoother refuses.
pub fn offsets(
    candidate: &Candidate,
    trials: &[Trial],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Vec<i32>, JudgeError> {
    let mut offsets = Vec::new();
    for (trial, rows) in trials.iter().zip(&candidate.logits) {
        let scores = score(
            trial,
            rows,
            &trial.lag_compensated,
            vocabulary,
            look_ahead.settings(),
        )?;
        offsets.extend(scores[BUFFERS.len() - 1].transitions.offsets());
    }
    Ok(offsets)
}

/// True against reference intents over all trials.
///
/// # Errors
/// When a metric or the smoother refuses.
pub fn confusion(
    candidate: &Candidate,
    trials: &[Trial],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Confusion, JudgeError> {
    let mut confusion = Confusion::new(vocabulary);
    for (trial, rows) in trials.iter().zip(&candidate.logits) {
        let track = track(
            rows,
            trial.emg.len(),
            vocabulary.classes(),
            look_ahead.settings(),
        )?;
        confusion.add(&trial.lag_compensated, &track.reference)?;
    }
    Ok(confusion)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_without_a_look_back_is_judged_without_look_ahead_alone() {
        let conditions = |looks_back| {
            let candidate = Candidate {
                name: "any".to_owned(),
                looks_back,
                logits: Vec::new(),
            };
            candidate.conditions().collect::<Vec<_>>()
        };
        assert_eq!(conditions(false), [LookAhead::None]);
        assert_eq!(conditions(true), LookAhead::ALL);
    }
}
