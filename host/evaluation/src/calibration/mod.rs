//! Calibration of a model by a person's own holds, with the code that a board runs ([`shared::calibration`]).
//!
//! A round is a hold of each gesture and two of rest. The first half of the rounds teaches, the other half judges the new
//! head beside the model's own. The new one is used, learnt from all rounds, if [`Judgement`] accepts it.

mod own;
mod parts;

use std::collections::btree_map::{BTreeMap, Entry};

use recordings::corpus::padded;
use serde::Serialize;
use shared::calibration::{
    Activity, FAVOUR, Judgement, MOST_PATCHES, Refusal, SCRATCH, Shown, Sums, solve,
};
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::model::head::Head;
use shared::stream::alignment::{Alignment, AlignmentOutcome, AlignmentProgress, Arm};
use shared::units::{PATCH, WINDOW_PATCHES};

pub use self::own::{FEWEST_ROUNDS, OwnCalibration, calibrate_file, calibrate_on};
pub use self::parts::{ShownPart, parts, rounds_of};
use crate::inference::logits_with;
use crate::model_evaluation::Lesson;
use crate::{EvaluatedRecording, EvaluationError, smooth};

/// Result of a calibration.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Calibration {
    /// Head to use; `None` if the model's own is kept.
    #[serde(skip)]
    pub head: Option<Head>,
    /// Mean recall of the classes in the rounds that judge, of the model's own head and of the new one; `None` if a single
    /// round teaches: no round is left to judge.
    pub judged: Option<[f32; 2]>,
    /// Reason why nothing was learnt; `None` if a head was.
    pub refusal: Option<String>,
    /// Alignment that the opening of the first round gave.
    #[serde(skip)]
    pub alignment: Alignment,
}

/// Calibrates a model on the first rounds of a person's parts, as the lesson says.
pub fn calibrate(
    model: &Model<'_>,
    recordings: &[&EvaluatedRecording],
    parts: &[ShownPart],
    lesson: Lesson,
) -> Result<Calibration, EvaluationError> {
    let Lesson {
        rounds,
        others,
        align,
    } = lesson;
    if rounds == 0 {
        return Ok(Calibration::default());
    }
    let wanted = |part: &&ShownPart| part.round < rounds && (others || part.shown != Shown::Other);
    let parts: Vec<&ShownPart> = parts.iter().filter(wanted).collect();
    let alignment = if align {
        alignment(model, recordings, &parts)?
    } else {
        Alignment::NONE
    };
    let mut hidden = BTreeMap::new();
    for part in &parts {
        if let Entry::Vacant(entry) = hidden.entry(part.recording) {
            entry.insert(hidden_vectors(
                model,
                recordings[part.recording],
                alignment,
            )?);
        }
    }
    let learnt = |rounds: usize| {
        let mut sums = Sums::EMPTY;
        for part in parts.iter().filter(|part| part.round < rounds) {
            for vector in hidden[&part.recording]
                .iter()
                .take(part.end())
                .skip(part.start())
            {
                sums.add(vector, part.shown);
            }
        }
        let (mut scratch, mut head) = ([0.0; SCRATCH], Head::EMPTY);
        solve(&sums, model, &mut scratch, &mut head).map(|()| head)
    };
    let refused = |refusal: Refusal| Calibration {
        refusal: Some(refusal.to_string()),
        alignment,
        ..Calibration::default()
    };
    let teaching = rounds.div_ceil(2);
    let judging = parts.iter().filter(|part| part.round >= teaching);
    let judging: Vec<&ShownPart> = judging.copied().collect();
    let mut head = match learnt(teaching) {
        Ok(head) => Some(head),
        Err(refusal) => return Ok(refused(refusal)),
    };
    let mut judged = None;
    if let Some(first) = head.take_if(|_| !judging.is_empty()) {
        let judgement = judge(model, &first, recordings, &judging, alignment)?;
        judged = Some(judgement.recalls());
        if judgement.accepts() {
            head = match learnt(rounds) {
                Ok(head) => Some(head),
                Err(refusal) => return Ok(refused(refusal)),
            };
        }
    }
    Ok(Calibration {
        head,
        judged,
        refusal: None,
        alignment,
    })
}

impl ShownPart {
    /// First patch to learn from.
    fn start(&self) -> usize {
        self.samples.start.div_ceil(PATCH)
    }

    /// One after the last patch to learn from.
    fn end(&self) -> usize {
        (self.samples.end / PATCH).min(self.start() + MOST_PATCHES)
    }
}

/// Alignment by the opening of the first round, as a board finds it.
fn alignment(
    model: &Model<'_>,
    recordings: &[&EvaluatedRecording],
    parts: &[&ShownPart],
) -> Result<Alignment, EvaluationError> {
    let open = Shown::Intent(Intent::Open);
    let opening = parts.iter().find(|part| part.shown == open);
    let (Some(template), Some(part)) = (&model.header.template, opening) else {
        return Ok(Alignment::NONE);
    };
    let recording = recordings[part.recording];
    let mut activity = Activity::default();
    let most = part.samples.start + MOST_PATCHES * PATCH;
    let samples = part.samples.start..part.samples.end.min(most);
    for &sample in &recording.raw[samples] {
        activity.add(sample);
    }
    let profile = activity.profile();
    let outcome = match AlignmentProgress::of(profile, Arm::Unknown, u64::MAX, template, FAVOUR) {
        AlignmentProgress::Done(outcome) => outcome,
        AlignmentProgress::Undecided(mut decision) => {
            let input = recording.input(model.header.preprocessing, Alignment::NONE);
            let patches = &input.as_chunks::<PATCH>().0[part.start()..part.end()];
            let encoder = HostEncoder::new(model)?;
            let mut state = encoder.fresh();
            let outputs = model.header.dimensions.row_outputs();
            decision.start(patches.len());
            loop {
                let next = decision.next();
                if next.is_first {
                    state.reset();
                }
                let patch = patches[patches.len() - 1 - next.back];
                let patch = patch.map(|sample| next.alignment.apply(sample));
                let rows = encoder.step(&mut state, &patch);
                if let Some(outcome) = decision.score(&rows, outputs) {
                    break outcome;
                }
            }
        }
        AlignmentProgress::Waiting | AlignmentProgress::Gesture => return Ok(Alignment::NONE),
    };
    Ok(match outcome {
        AlignmentOutcome::Aligned(fit) => fit.alignment,
        AlignmentOutcome::Poor(..) | AlignmentOutcome::Timeout => Alignment::NONE,
    })
}

fn hidden_vectors(
    model: &Model<'_>,
    recording: &EvaluatedRecording,
    alignment: Alignment,
) -> Result<Vec<Vec<f32>>, EvaluationError> {
    let encoder = HostEncoder::new(model)?;
    let mut state = encoder.fresh();
    let stream = padded(&recording.input(model.header.preprocessing, alignment));
    let (patches, _) = stream.as_chunks::<PATCH>();
    let vectors = patches.iter().map(|patch| {
        let _ = encoder.step(&mut state, patch);
        encoder.hidden(&state).to_vec()
    });
    Ok(vectors.collect::<Vec<_>>().split_off(WINDOW_PATCHES))
}

/// Judges a learnt head, aligned, beside the model's own, not aligned, by the samples in these parts, as emitted.
fn judge(
    model: &Model<'_>,
    learnt: &Head,
    recordings: &[&EvaluatedRecording],
    parts: &[&ShownPart],
    alignment: Alignment,
) -> Result<Judgement, EvaluationError> {
    let classes = model.header.dimensions.vocabulary.classes();
    let settings = model.header.smoother.in_patches();
    let emitted = |recording: &EvaluatedRecording, head, alignment| {
        let input = recording.input(model.header.preprocessing, alignment);
        let logits = logits_with(model, head, &input)?;
        Ok::<_, EvaluationError>(smooth(&logits, recording.emg.len(), classes, settings)?.emitted)
    };
    let mut labels = BTreeMap::new();
    let mut judgement = Judgement::default();
    for part in parts {
        let Shown::Intent(asked) = part.shown else {
            continue;
        };
        if let Entry::Vacant(entry) = labels.entry(part.recording) {
            let recording = recordings[part.recording];
            entry.insert([
                emitted(recording, None, Alignment::NONE)?,
                emitted(recording, Some(learnt), alignment)?,
            ]);
        }
        let both = labels[&part.recording].each_ref();
        for sample in part.samples.clone() {
            judgement.add(asked, both.map(|own| own[sample]));
        }
    }
    Ok(judgement)
}

#[cfg(test)]
mod tests;
