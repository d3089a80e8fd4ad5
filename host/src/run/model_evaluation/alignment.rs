//! How people wear the armband, and what alignment makes of it.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;
use shared::intent::Intent;
use shared::model::file::Model;
use shared::stream::alignment::{Alignment, Outcome, Poor};
use shared::units::{CHANNELS, Sample};

use super::named_model::NamedModel;
use crate::dataset::alignment::{Openings, openings};
use crate::evaluation::{Candidate, Trial};
use crate::inference::integer_logits;
use crate::run::error::StepError;

/// How the armband sits, after the data set's own frame is accounted for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Worn {
    /// Places that it is turned by.
    pub turn: Turn,
    /// Whether it is on the other arm.
    pub mirrored: bool,
}

/// Places that armbands are turned by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turn {
    /// All by the same number, 0 to 7.
    By(u8),
    /// By 0 to 7 in turn, from person to person in alphabetical order.
    Any,
}

impl Default for Turn {
    fn default() -> Self {
        Self::By(0)
    }
}

impl Worn {
    /// The placement of a person; `number` is the place in the alphabetical order.
    pub(super) fn of(self, number: usize) -> Alignment {
        let turn = match self.turn {
            Turn::By(turn) => turn,
            Turn::Any => (number % CHANNELS) as u8,
        };
        Alignment::new(turn, self.mirrored)
    }
}

/// One person's alignment for one model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AlignedSubject {
    /// The model's name.
    pub model: String,
    /// The person.
    pub subject: String,
    /// What came of it: `aligned`, `poor-distance`, `poor-margin`, `timeout`, or `unavailable` without a template.
    pub outcome: &'static str,
    /// Places between the placement found and the frame of the data set, 0 to 4; none on the other arm, or if nothing was
    /// applied.
    pub places_off: Option<u8>,
    /// Whether the placement found is on the other arm than the frame of the data set.
    pub wrong_arm: bool,
    /// Distance and margin in hundredths of a nat; none without a placement.
    pub quality: Option<(u32, u32)>,
}

/// What alignment made of everybody.
#[derive(Default)]
pub(super) struct Aligned {
    /// A result for each model and person.
    pub(super) results: Vec<AlignedSubject>,
    /// Each model's alignments; none where nothing was to be changed.
    pub(super) found: Vec<BTreeMap<String, Alignment>>,
    /// How many openings were taken of each person, at most.
    pub(super) taken: BTreeMap<String, usize>,
}

/// The openings of each person who has enough of them.
pub(super) fn openings_of(trials: &[Trial]) -> BTreeMap<String, (Openings, Vec<usize>)> {
    let mut own: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (at, trial) in trials.iter().enumerate() {
        own.entry(&trial.subject).or_default().push(at);
    }
    own.into_iter()
        .filter_map(|(subject, places)| {
            let recordings: Vec<(&[Sample], &[Option<Intent>])> = places
                .iter()
                .map(|&at| (&trials[at].raw[..], &trials[at].lag_compensated[..]))
                .collect();
            Some((subject.to_owned(), (openings(&recordings)?, places)))
        })
        .collect()
}

/// What each model's template makes of each person's openings.
pub(super) fn align(
    models: &[(&NamedModel, &Model<'_>)],
    people: &BTreeMap<String, (Openings, Vec<usize>)>,
    worn: &BTreeMap<String, Alignment>,
) -> Aligned {
    let mut results = Vec::new();
    let mut found = Vec::new();
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for (named, model) in models {
        let mut own = BTreeMap::new();
        for (subject, (openings, _)) in people {
            let (outcome, count) = model
                .header
                .template
                .as_ref()
                .map_or((None, 0), |template| {
                    let (outcome, count) = openings.outcome(template);
                    (Some(outcome), count)
                });
            let most = taken.entry(subject.clone()).or_default();
            *most = count.max(*most);
            let (name, fit) = match outcome {
                None => ("unavailable", None),
                Some(Outcome::Timeout) => ("timeout", None),
                Some(Outcome::Aligned(fit)) => ("aligned", Some(fit)),
                Some(Outcome::Poor(fit, Poor::Distance)) => ("poor-distance", Some(fit)),
                Some(Outcome::Poor(fit, Poor::Margin)) => ("poor-margin", Some(fit)),
            };
            let applied = fit.filter(|_| name == "aligned").map(|fit| fit.alignment);
            let truth = worn.get(subject).copied().unwrap_or_default();
            results.push(AlignedSubject {
                model: named.name.clone(),
                subject: subject.clone(),
                outcome: name,
                places_off: applied.and_then(|found| found.places_from(truth)),
                wrong_arm: applied.is_some_and(|found| found.mirrored() != truth.mirrored()),
                quality: fit.map(|fit| (fit.distance, fit.margin)),
            });
            own.insert(subject.clone(), applied.unwrap_or_default());
        }
        found.push(own);
    }
    Aligned {
        results,
        found,
        taken,
    }
}

/// The labels of the openings that were taken, in all trials of these people, become none: they are not scored.
pub(super) fn leave_out_openings(
    trials: &mut [Trial],
    people: &BTreeMap<String, (Openings, Vec<usize>)>,
    taken: &BTreeMap<String, usize>,
) {
    for (subject, (openings, places)) in people {
        let count = taken.get(subject).copied().unwrap_or_default();
        for (recording, &at) in places.iter().enumerate() {
            for range in openings.used(recording, count) {
                let trial = &mut trials[at];
                if let Some(published) = &mut trial.published {
                    published[range.clone()].fill(None);
                }
                trial.lag_compensated[range].fill(None);
            }
        }
    }
}

/// The logits of a model whose electrodes are aligned for each person.
///
/// # Errors
/// When the encoder refuses the model.
pub(super) fn aligned_candidate(
    name: &str,
    model: &Model<'_>,
    trials: &[Trial],
    alignments: &BTreeMap<String, Alignment>,
) -> Result<Candidate, StepError> {
    let logits = trials
        .par_iter()
        .map(|trial| {
            let alignment = alignments.get(&trial.subject).copied().unwrap_or_default();
            let emg: Vec<_> = trial
                .input(model.header.preprocessing)
                .iter()
                .map(|&sample| alignment.apply(sample))
                .collect();
            integer_logits(model, &emg)
        })
        .collect::<Result<_, _>>()?;
    Ok(Candidate {
        name: format!("{name}, aligned"),
        looks_back: true,
        logits,
        entry_margins: model.header.smoother.entry_margins,
        other_margin: model.header.smoother.other_margin,
    })
}
