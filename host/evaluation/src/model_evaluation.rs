//! Evaluation of model files on any recordings, without a run folder.

mod alignment;
mod calibration;
mod named_model;
mod subjects;

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;
use shared::intent::Vocabulary;
use shared::model::file::{Model, SmootherDefaults};
use shared::stream::alignment::Alignment;
use shared::stream::smoother::AggregationMode;
use shared::units::Sample;

use self::alignment::{Aligned, align, leave_out_openings, openings_of};
pub use self::alignment::{AlignedSubject, Turn, Worn};
pub use self::calibration::{CalibratedSubject, Lesson, SET_ASIDE};
use self::calibration::{calibrated, calibrated_candidate, people_of, set_aside};
pub(crate) use self::named_model::SEEN;
pub use self::named_model::{NamedModel, beside, is_taken};
use self::named_model::{common_vocabulary, distinct};
pub use self::subjects::EvaluatedSubject;
use self::subjects::subjects;
use crate::candidate::candidate;
use crate::{
    Candidate, Cued, EnergyDetector, EvaluatedRecording, EvaluationError, LookAhead, Score, System,
    constant, cued, integer_candidate, score,
};
use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::{Lag, lags};
use recordings::split::predefined;
use recordings::synthetic::losses::bridge_lost_notifications;
use recordings::{DataSet, Library, Recording};

/// Selection of the people to evaluate on, and settings of the evaluation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Subjects (`data-set/subject`) and whole data sets; everybody if empty. A person who is named is evaluated, seen
    /// or not; test people only by their own names.
    pub subjects: Vec<String>,
    /// Whether people whom one of the models was trained on or validated with are evaluated too.
    pub seen: bool,
    /// Whether test people are evaluated too.
    pub test: bool,
    /// Placement of the armband.
    pub worn: Worn,
    /// Whether each model is also evaluated after alignment. Only people who open the hand twice are evaluated then,
    /// and those openings are not scored.
    pub align: bool,
    /// Whether alignments are told on which arm the armband is.
    pub arm_told: bool,
    /// Whether each model is also evaluated after calibration, and by what. Only people with [`SET_ASIDE`] rounds are
    /// evaluated then, and these rounds are not scored.
    pub calibrate: Option<Lesson>,
    /// Percent of the notifications that are lost and bridged, 0 to 66.
    pub lost_percent: u8,
    /// Lag compensation of the labels.
    pub label_lag: LabelLag,
}

/// A model in the results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvaluatedModel {
    /// Name in tables.
    pub name: String,
    /// Look-ahead and aggregation mode of the file.
    pub look_ahead: LookAhead,
    /// Revision of the program that trained it.
    pub git_revision: String,
    /// Seed of its training.
    pub seed: u64,
    /// CRC-32 at the end of the file, which identifies it.
    pub checksum: String,
}

/// Scores of model files on recordings, each at its own look-ahead; lag-compensated labels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelResults {
    /// The models.
    pub models: Vec<EvaluatedModel>,
    /// People whom they were evaluated on.
    pub subjects: Vec<EvaluatedSubject>,
    /// People left out because a model has seen them.
    pub left_out_seen: Vec<String>,
    /// Test people left out.
    pub left_out_test: Vec<String>,
    /// People left out because they do not open the hand twice, if alignment was asked for.
    pub left_out_openings: Vec<String>,
    /// People left out because they have fewer than [`SET_ASIDE`] holds of a gesture, if calibration was asked for.
    pub left_out_holds: Vec<String>,
    /// Result of the calibration for each model and person; empty if it was not asked for.
    pub calibrations: Vec<CalibratedSubject>,
    /// Placement of the armband.
    pub worn: Worn,
    /// Result of the alignment for each model and person; empty if it was not asked for.
    pub alignments: Vec<AlignedSubject>,
    /// Percent of the notifications that were lost and bridged.
    pub lost_percent: u8,
    /// Lag compensation of the labels, by data set.
    pub lags: BTreeMap<DataSet, Lag>,
    /// Numbers of gestures of the evaluated people, asked for and scored, by data set.
    pub gestures: BTreeMap<DataSet, Cued>,
    /// Scores: a row for each model and floor, for each data set and over all of them.
    pub scores: Vec<Score>,
}

/// Results, and the recordings and candidates that they were computed from.
pub struct ModelEvaluation {
    /// The results.
    pub results: ModelResults,
    /// The recordings.
    pub recordings: Vec<EvaluatedRecording>,
    /// Models and floors.
    pub candidates: Vec<Candidate>,
    /// Classes of the models.
    pub vocabulary: Vocabulary,
}

/// Evaluates model files on the recordings of a library.
///
/// People whom one of the models has seen are left out, and so are test people, unless the selection says otherwise.
/// Labels are compensated for their lag as the selection says, by default cue by cue. A constant lag of a data set is
/// estimated on its training people (`host/recordings/people.toml`). Labels that mark the muscle's activity have no
/// lag. The energy detector is the default one, since there are no training people.
///
/// # Errors
/// When a model is refused, models have one name or different classes, a name is unknown, or nobody is left.
///
/// # Panics
/// If the selection loses more than 66 % of the notifications.
pub fn evaluate_models(
    models: &[NamedModel],
    library: &Library,
    selection: &Selection,
) -> Result<ModelEvaluation, EvaluationError> {
    distinct(models)?;
    let parsed = models
        .iter()
        .map(|model| Ok(Model::parse(&model.bytes)?))
        .collect::<Result<Vec<_>, EvaluationError>>()?;
    let vocabulary = common_vocabulary(models, &parsed)?;
    let labelled = labelled(library, vocabulary);
    let (mut subjects, left_out) = subjects(models, &parsed, &labelled, selection)?;
    let lags = lags(&labelled, selection.label_lag, &predefined::is_training);
    let worn: BTreeMap<String, Alignment> = subjects
        .iter()
        .enumerate()
        .map(|(number, own)| (own.subject.clone(), selection.worn.of(number)))
        .collect();
    let mut recordings = evaluated_recordings(&labelled, vocabulary, &lags, |recording| {
        let placed = worn.get(&recording.subject)?.inverse();
        let name = recording.full_name();
        Some(move |samples: &mut Vec<Sample>| {
            for sample in &mut *samples {
                *sample = placed.apply(*sample);
            }
            bridge_lost_notifications(samples, selection.lost_percent, &name);
        })
    });
    let mut gestures = cued(&recordings);
    let named: Vec<(&NamedModel, &Model<'_>)> = models.iter().zip(&parsed).collect();
    let mut left_out_openings = Vec::new();
    let mut aligned = Aligned::default();
    if selection.align {
        let people = openings_of(&recordings);
        left_out_openings = leave_out(&mut subjects, &people);
        if subjects.is_empty() {
            return Err(EvaluationError::NobodyOpens(left_out_openings.len()));
        }
        aligned = align(&named, &people, &worn, selection.arm_told)?;
        let is_left = |own: &EvaluatedRecording| people.contains_key(&own.subject);
        gestures = cued(recordings.iter().filter(|own| is_left(own)));
        leave_out_openings(&mut recordings, &people, &aligned.taken);
        recordings.retain(is_left);
    }
    let mut left_out_holds = Vec::new();
    let mut calibrations = Vec::new();
    if let Some(lesson) = selection.calibrate {
        let people = people_of(&recordings, vocabulary);
        left_out_holds = leave_out(&mut subjects, &people);
        if subjects.is_empty() {
            return Err(EvaluationError::NobodyHolds(left_out_holds.len()));
        }
        calibrations = calibrated(&named, &recordings, &people, lesson)?;
        set_aside(&mut recordings, &people);
        recordings.retain(|recording| people.contains_key(&recording.subject));
        gestures = cued(&recordings);
    }
    let mut candidates = named
        .iter()
        .map(|(model, parsed)| integer_candidate(&model.name[..], parsed, &recordings))
        .collect::<Result<Vec<_>, _>>()?;
    for ((model, parsed), own) in named.iter().zip(&aligned.found) {
        let aligned = System::Aligned(model.name.clone());
        candidates.push(candidate(aligned, parsed, &recordings, |recording| {
            let alignment = own.get(&recording.subject).copied();
            (alignment.unwrap_or_default(), None)
        })?);
    }
    if selection.calibrate.is_some_and(|lesson| lesson.rounds > 0) {
        for (model, parsed) in &named {
            let own = calibrated_candidate(&model.name, parsed, &recordings, &calibrations)?;
            candidates.push(own);
        }
    }
    candidates.push(constant(&recordings));
    candidates.push(EnergyDetector::default().candidate(&recordings));
    let models: Vec<EvaluatedModel> = named
        .iter()
        .map(|(model, parsed)| evaluated_model(model, parsed))
        .collect();
    let mut scores = Vec::new();
    for candidate in &candidates {
        let mut own = models.iter();
        let own = own.find(|own| candidate.model.model() == Some(&own.name));
        let look_ahead = own.map_or(LookAhead::None, |own| own.look_ahead);
        scores.extend(score(candidate, &recordings, vocabulary, look_ahead)?);
    }
    Ok(ModelEvaluation {
        results: ModelResults {
            models,
            subjects,
            left_out_seen: left_out.seen,
            left_out_test: left_out.test,
            left_out_openings,
            left_out_holds,
            calibrations,
            worn: selection.worn,
            alignments: aligned.results,
            lost_percent: selection.lost_percent,
            lags,
            gestures,
            scores,
        },
        recordings,
        candidates,
        vocabulary,
    })
}

/// The labelled recordings of some people (`data-set/subject`) of a library that is as recorded, as [`evaluate_models`]
/// evaluates them: in the common frame. A constant lag is estimated on the training people that are given.
pub fn recordings_of(
    library: &Library,
    vocabulary: Vocabulary,
    people: &[String],
    is_training: &dyn Fn(&str) -> bool,
) -> Vec<EvaluatedRecording> {
    let labelled = labelled(library, vocabulary);
    let lags = lags(&labelled, LabelLag::default(), is_training);
    evaluated_recordings(&labelled, vocabulary, &lags, |recording| {
        let data_set = recording.data_set;
        let align = move |samples: &mut Vec<Sample>| data_set.align(samples);
        people.contains(&recording.subject).then_some(align)
    })
}

/// Recordings that models of a vocabulary can be evaluated on.
pub(crate) fn labelled(library: &Library, vocabulary: Vocabulary) -> Vec<&Recording> {
    let recordings = library.recordings.iter();
    recordings
        .filter(|recording| recording.can_be_evaluated(vocabulary))
        .collect()
}

/// Recordings with their samples as `arranged` changes them; those for which it gives nothing are left out.
pub(crate) fn evaluated_recordings<A: Fn(&mut Vec<Sample>)>(
    labelled: &[&Recording],
    vocabulary: Vocabulary,
    lags: &BTreeMap<DataSet, Lag>,
    arranged: impl Fn(&Recording) -> Option<A> + Sync,
) -> Vec<EvaluatedRecording> {
    labelled
        .par_iter()
        .filter_map(|recording| {
            let arrange = arranged(recording)?;
            let compensation = lags[&recording.data_set].of_recording(recording);
            Some(EvaluatedRecording::new(
                recording,
                arrange,
                vocabulary,
                compensation,
            ))
        })
        .collect()
}

/// Leaves out the subjects who are not among these people, and returns their names.
fn leave_out<P>(subjects: &mut Vec<EvaluatedSubject>, people: &BTreeMap<String, P>) -> Vec<String> {
    let is_out = |own: &mut EvaluatedSubject| !people.contains_key(&own.subject);
    let out = subjects.extract_if(.., is_out);
    out.map(|own| own.subject).collect()
}

fn evaluated_model(model: &NamedModel, parsed: &Model<'_>) -> EvaluatedModel {
    let smoother = &parsed.header.smoother;
    let provenance = &parsed.header.provenance;
    let checksum = model.bytes[..parsed.length].last_chunk::<4>();
    EvaluatedModel {
        name: model.name.clone(),
        look_ahead: look_ahead(smoother),
        git_revision: provenance.git_revision.to_owned(),
        seed: provenance.seed,
        checksum: checksum.map_or_else(String::new, |bytes| {
            format!("{:08x}", u32::from_le_bytes(*bytes))
        }),
    }
}

/// Look-ahead and aggregation mode of a model file.
pub const fn look_ahead(smoother: &SmootherDefaults) -> LookAhead {
    match (smoother.look_ahead, smoother.aggregation) {
        (0, _) => LookAhead::None,
        (_, AggregationMode::AllRowsFrom) => LookAhead::AllRows,
        (_, AggregationMode::SameInstant) => LookAhead::SameInstant,
    }
}
