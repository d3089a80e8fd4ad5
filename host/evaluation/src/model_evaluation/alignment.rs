//! Placement of the armband, and alignment of models to it.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use rayon::prelude::*;
use serde::{Serialize, Serializer};
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::stream::alignment::{Alignment, Arm};
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::line::Line;
use shared::units::{CHANNELS, Sample};

use super::named_model::NamedModel;
use crate::inference::Stream;
use crate::{EvaluatedRecording, EvaluationError};
use recordings::alignment::{Openings, openings};

/// Placement of the armband, after the data set's own frame is accounted for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Worn {
    /// Places by which it is turned.
    pub turn: Turn,
    /// Whether it is on the other arm.
    pub mirrored: bool,
}

/// Places by which armbands are turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turn {
    /// Number of places that everybody is turned by, 0 to 7.
    By(u8),
    /// 0 to 7 in turn, from person to person in alphabetical order.
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
    /// Outcome: aligned, poor distance, poor margin, timeout, or unavailable without a template.
    #[serde(serialize_with = "name_of")]
    pub outcome: AlignmentState,
    /// Places between the placement found and the frame of the data set, 0 to 4; none on the other arm, or if nothing
    /// was applied.
    pub places_off: Option<u8>,
    /// Whether the placement found is on the other arm than the frame of the data set.
    pub wrong_arm: bool,
    /// Distance and margin in hundredths of a nat; none without a placement.
    pub quality: Option<(u32, u32)>,
}

fn name_of<S: Serializer>(state: &AlignmentState, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(state.name())
}

#[derive(Default)]
pub(super) struct Aligned {
    /// A result for each model and person.
    pub(super) results: Vec<AlignedSubject>,
    /// Alignments of each model, by person; none where nothing is changed.
    pub(super) found: Vec<BTreeMap<String, Alignment>>,
    /// Maximum number of openings that were taken of each person.
    pub(super) taken: BTreeMap<String, usize>,
}

/// The openings of each person who has enough of them.
pub(super) fn openings_of(
    recordings: &[EvaluatedRecording],
) -> BTreeMap<String, (Openings, Vec<usize>)> {
    EvaluatedRecording::places(recordings)
        .into_iter()
        .filter_map(|(subject, places)| {
            let pairs: Vec<(&[Sample], &[Option<Intent>])> = places
                .iter()
                .map(|&at| (&recordings[at].raw[..], &recordings[at].lag_compensated[..]))
                .collect();
            Some((subject.to_owned(), (openings(&pairs)?, places)))
        })
        .collect()
}

/// Alignment by each person's openings of a board with each model; `arm_told`: it is told on which arm the armband is.
pub(super) fn align(
    models: &[(&NamedModel, &Model<'_>)],
    people: &BTreeMap<String, (Openings, Vec<usize>)>,
    worn: &BTreeMap<String, Alignment>,
    arm_told: bool,
) -> Result<Aligned, EvaluationError> {
    let mut aligned = Aligned::default();
    let placed = |subject: &str| worn.get(subject).copied().unwrap_or_default();
    for (named, model) in models {
        let answers = people
            .par_iter()
            .map(|(subject, (openings, _))| {
                let mirrored = placed(subject).mirrored();
                let arm = if arm_told {
                    Arm::Known { mirrored }
                } else {
                    Arm::Unknown
                };
                Ok((subject, answer(model, openings, arm)?))
            })
            .collect::<Result<Vec<_>, EvaluationError>>()?;
        let mut own = BTreeMap::new();
        for (subject, (report, count)) in answers {
            let most = aligned.taken.entry(subject.clone()).or_default();
            *most = count.max(*most);
            let truth = placed(subject);
            let state = report.map_or(AlignmentState::Timeout, |report| report.state);
            let applied = report.filter(|report| report.state == AlignmentState::Aligned);
            let applied = applied.map(|report| report.alignment);
            aligned.results.push(AlignedSubject {
                model: named.name.clone(),
                subject: subject.clone(),
                outcome: state,
                places_off: applied.and_then(|found| found.places_from(truth)),
                wrong_arm: applied.is_some_and(|found| found.mirrored() != truth.mirrored()),
                quality: report
                    .and_then(|report| report.quality)
                    .map(|own| (own.distance, own.margin)),
            });
            own.insert(subject.clone(), applied.unwrap_or_default());
        }
        aligned.found.push(own);
    }
    Ok(aligned)
}

/// Report with which a board ends an alignment by these openings, or none if it still waits for more at their end; and
/// the number of openings that it took. The board is switched on with their first sample.
fn answer(
    model: &Model<'_>,
    openings: &Openings,
    arm: Arm,
) -> Result<(Option<AlignmentReport>, usize), EvaluationError> {
    let encoder = HostEncoder::new(model)?;
    let mut state = encoder.fresh();
    let mut board = Stream::new(model, encoder, &mut state, Some(arm))?;
    let stream = openings.stream();
    let ended = board.push(
        &stream,
        |_| (),
        |line| match line {
            Line::Alignment(report) if report.state != AlignmentState::Waiting => {
                ControlFlow::Break(report)
            }
            _ => ControlFlow::Continue(()),
        },
    );
    Ok(match ended {
        ControlFlow::Break(report) => {
            let samples = report.emitted.0 as usize + 1;
            (Some(report), openings.within(samples))
        }
        ControlFlow::Continue(()) => (None, openings.within(stream.len())),
    })
}

/// Removes the labels of the openings that were taken, in all recordings of these people: they are not scored.
pub(super) fn leave_out_openings(
    recordings: &mut [EvaluatedRecording],
    people: &BTreeMap<String, (Openings, Vec<usize>)>,
    taken: &BTreeMap<String, usize>,
) {
    for (subject, (openings, places)) in people {
        let count = taken.get(subject).copied().unwrap_or_default();
        for (number, &at) in places.iter().enumerate() {
            for range in openings.used(number, count) {
                recordings[at].unlabel(range);
            }
        }
    }
}
