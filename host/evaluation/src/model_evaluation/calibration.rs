//! Calibration of models by each person's first holds, judged on the remainder.

use std::collections::BTreeMap;

use rayon::prelude::*;
use recordings::statistics::MeanSd;
use serde::Serialize;
use shared::calibration::Shown;
use shared::intent::Vocabulary;
use shared::model::file::Model;
use shared::model::head::Head;
use shared::stream::alignment::Alignment;

use super::look_ahead;
use super::named_model::NamedModel;
use crate::calibration::{Calibration, ShownPart, calibrate, parts, rounds_of};
use crate::candidate::candidate;
use crate::{Candidate, EvaluatedRecording, EvaluationError, Measure, System, score};

/// Rounds of each person that are not scored, so that any number of rounds is judged on the same remainder.
pub const SET_ASIDE: usize = 4;

/// Rounds and movements that each person shows to a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lesson {
    /// Rounds, 0 to [`SET_ASIDE`]; with 0 nothing is calibrated, and the same remainder is judged.
    pub rounds: usize,
    /// Whether six seconds of other movement are shown too.
    pub others: bool,
    /// Whether the opening of the first round aligns the armband, as on a board.
    pub align: bool,
}

/// One person's calibration of one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibratedSubject {
    /// The model's name.
    pub model: String,
    /// The person.
    pub subject: String,
    /// Whether the new head is used.
    pub new_head: bool,
    /// Result of the calibration.
    #[serde(flatten)]
    pub calibration: Calibration,
    /// Activations a minute of daily life with the model's own head and with this one: mean over the people with daily life who
    /// are not calibrated themselves; `None` without any.
    pub daily: Option<[f64; 2]>,
}

/// People who can be calibrated: indices of their recordings, and the parts that are set aside.
pub(super) type People = BTreeMap<String, (Vec<usize>, Vec<ShownPart>)>;

/// People with [`SET_ASIDE`] rounds.
pub(super) fn people_of(recordings: &[EvaluatedRecording], vocabulary: Vocabulary) -> People {
    EvaluatedRecording::places(recordings)
        .into_iter()
        .filter_map(|(subject, places)| {
            let own = own(recordings, &places);
            (rounds_of(&own, vocabulary) >= SET_ASIDE).then(|| {
                let parts = parts(&own, vocabulary, SET_ASIDE);
                (subject.to_owned(), (places, parts))
            })
        })
        .collect()
}

fn own<'r>(recordings: &'r [EvaluatedRecording], places: &[usize]) -> Vec<&'r EvaluatedRecording> {
    places.iter().map(|&at| &recordings[at]).collect()
}

pub(super) fn calibrated(
    models: &[(&NamedModel, &Model<'_>)],
    recordings: &[EvaluatedRecording],
    people: &People,
    lesson: Lesson,
) -> Result<Vec<CalibratedSubject>, EvaluationError> {
    let is_daily = |own: &&EvaluatedRecording| {
        let mut movements = own.other_movement.iter();
        !people.contains_key(&own.subject) && movements.any(|own| own.kind.is_daily())
    };
    let daily: Vec<EvaluatedRecording> = recordings.iter().filter(is_daily).cloned().collect();
    let mut all = Vec::new();
    for (named, model) in models {
        let before = daily_per_minute(model, None, &daily)?;
        let answers = people
            .par_iter()
            .map(|(subject, (places, parts))| {
                let own = own(recordings, places);
                let calibration = calibrate(model, &own, parts, lesson)?;
                let after = match &calibration.head {
                    Some(head) => daily_per_minute(model, Some(head), &daily)?,
                    None => before,
                };
                Ok(CalibratedSubject {
                    model: named.name.clone(),
                    subject: subject.clone(),
                    new_head: calibration.head.is_some(),
                    daily: before.zip(after).map(<[f64; 2]>::from),
                    calibration,
                })
            })
            .collect::<Result<Vec<_>, EvaluationError>>()?;
        all.extend(answers);
    }
    Ok(all)
}

/// Activations a minute of daily life with a head, or with the model's own: mean over people; `None` without any.
fn daily_per_minute(
    model: &Model<'_>,
    head: Option<&Head>,
    daily: &[EvaluatedRecording],
) -> Result<Option<f64>, EvaluationError> {
    let candidate = candidate("", model, daily, |_| (Alignment::NONE, head))?;
    let vocabulary = model.header.dimensions.vocabulary;
    let smoother = &model.header.smoother;
    let scores = score(&candidate, daily, vocabulary, look_ahead(smoother))?;
    let rates = scores
        .iter()
        .flat_map(|score| Measure::DailyActivations.values(score));
    // A person's rate is in the row of their set and in that of all sets.
    let rates: BTreeMap<&str, f64> = rates.collect();
    let rates: Vec<f64> = rates.into_values().collect();
    Ok(MeanSd::of(&rates).map(|rate| rate.mean))
}

/// Removes the labels and other movements of the parts that are set aside.
pub(super) fn set_aside(recordings: &mut [EvaluatedRecording], people: &People) {
    for (places, parts) in people.values() {
        for part in parts {
            let recording = &mut recordings[places[part.recording]];
            if part.shown == Shown::Other {
                let start = part.samples.start;
                let movements = &mut recording.other_movement;
                movements.retain(|own| own.samples.start != start);
            }
            recording.unlabel(part.samples.clone());
        }
    }
}

pub(super) fn calibrated_candidate(
    name: &str,
    model: &Model<'_>,
    recordings: &[EvaluatedRecording],
    calibrations: &[CalibratedSubject],
) -> Result<Candidate, EvaluationError> {
    let own = calibrations.iter().filter(|own| own.model == name);
    let people: BTreeMap<&str, &Calibration> = own
        .map(|own| (&own.subject[..], &own.calibration))
        .collect();
    let calibrated = System::Calibrated(name.to_owned());
    candidate(calibrated, model, recordings, |own| {
        let own = people.get(&own.subject[..]);
        own.map_or((Alignment::NONE, None), |own| {
            (own.alignment, own.head.as_ref())
        })
    })
}
