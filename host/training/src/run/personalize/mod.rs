//! Fine-tuning of a model file on one person's own recordings.
//!
//! A part of the recordings is tuned on. The rest is held back, and the old and the new integer model are judged on it as by
//! `evaluate --model`. Measured in docs/personalization.md.

mod error;
mod exchange;
mod judgement;
mod part;
mod person;
mod rule;
mod tuning;

use burn::tensor::Device;
use shared::model::file::Model;

pub use self::error::{Doubt, Exchange, PersonalizeError};
use self::exchange::exchange;
use self::judgement::Judgement;
pub use self::judgement::judge;
pub use self::part::PersonPart;
pub use self::person::PersonRecordings;
pub use self::rule::{Fallen, Worse};
use self::rule::{is_constant, worse};
pub use self::tuning::{TuningSettings, tune};
use crate::run::StepError;
use evaluation::Score;
use execution::interrupt::Interrupt;
use execution::progress;
use recordings::Library;

/// Result of a personalization.
#[derive(Clone, Debug)]
pub struct Personalized {
    /// Bytes of the new model file.
    pub bytes: Vec<u8>,
    /// Name of the person, as `data-set/subject`.
    pub subject: String,
    /// Whether the old model was trained on or validated with this person: its scores are then too good.
    pub seen_before: bool,
    /// Seconds of the part that was tuned on.
    pub tuned_seconds: f64,
    /// Seconds of the part that was held back.
    pub judged_seconds: f64,
    /// Doubts about the recordings.
    pub doubts: Vec<Doubt>,
    /// Scores on the part held back: the old model, the new one, and always relax.
    pub scores: [Score; 3],
}

impl Personalized {
    /// Reason why the new model is worse than the old one (`worse`); none if it is not.
    pub fn worse(&self) -> Option<Worse> {
        let [old, new, constant] = &self.scores;
        worse(old, new, constant)
    }
}

/// Fine-tunes a model file on a part of a person's recordings, and judges it on the part held back.
///
/// Without a name, the recordings must be of one person. After each step, `report` gets the number of steps done
/// and of all.
pub fn personalize(
    file: &[u8],
    library: &Library,
    subject: Option<&str>,
    settings: &TuningSettings,
    device: &Device,
    interrupt: &Interrupt,
    mut report: impl FnMut(usize, usize),
) -> Result<Personalized, PersonalizeError> {
    let model = Model::parse(file)?;
    let person = PersonRecordings::new(library, subject, &model.header)?;
    if !person.outside().is_empty() {
        progress::log(&format!(
            "gestures that the model does not have, counted as none: {}",
            person.outside().join(", ")
        ));
    }
    progress::log(&format!("labels: {}", person.lag()));
    let exchanged = exchange(file, &person)?;
    if let Some(found) = exchanged.clone().filter(|found| found.is_mutual) {
        return Err(PersonalizeError::Exchanged(found));
    }
    let whole = person.whole();
    let divisions = whole.divisions()?;
    let before = joined(
        divisions
            .iter()
            .map(|(_, judged)| Judgement::new("before", file, judged)),
    )?;
    // The half that chooses a margin judges neither it nor the model before.
    let before = match settings.other_per_minute {
        Some(_) => before.halves().1,
        None => before,
    };
    let (old, constant) = (before.score()?, before.constant()?);
    let constant_before = is_constant(&old, &constant).then_some(Doubt::ConstantBefore);
    let doubts = [exchanged.map(Doubt::Exchanged), constant_before];
    let doubts: Vec<_> = doubts.into_iter().flatten().collect();
    for doubt in &doubts {
        progress::log(&format!("warning: {doubt}"));
    }
    // A single part is tuned on and judged; of several, each is judged by a model of the others, and the new model learns from all.
    let (tuned, is_whole) = match &divisions[..] {
        [(tuned, _)] => (tuned, false),
        _ => (&whole, true),
    };
    let judged_seconds = divisions.iter().map(|(_, judged)| judged.seconds()).sum();
    progress::log(&format!(
        "{}: {:.0} s to tune on, {judged_seconds:.0} s held back{}",
        person.subject(),
        tuned.seconds(),
        if is_whole {
            ", a quarter at a time: a third is too short to judge"
        } else {
            ""
        }
    ));
    let bytes = tune(file, tuned, settings, device, interrupt, &mut report)?;
    let after = joined(divisions.iter().map(|(part, judged)| {
        if is_whole {
            let own = tune(file, part, settings, device, interrupt, |_, _| ())?;
            Judgement::new("after", &own, judged)
        } else {
            Judgement::new("after", &bytes, judged)
        }
    }))?;
    let (bytes, after) = match settings.other_per_minute {
        Some(wanted) => {
            let (mut choosing, mut judging) = after.halves();
            let margin = choosing.raise_margin(wanted)?;
            judging.set_margin(margin);
            (Model::with_gate(&bytes, None, Some(margin), None)?, judging)
        }
        None => (bytes, after),
    };
    let scores = [old, after.score()?, constant];
    let mut seen = model.header.provenance.subjects_seen.iter();
    Ok(Personalized {
        subject: person.subject().to_owned(),
        seen_before: seen.any(|seen| seen == person.subject()),
        tuned_seconds: tuned.seconds(),
        judged_seconds,
        bytes,
        doubts,
        scores,
    })
}

/// Joins the judgements of the parts held back.
fn joined(
    mut parts: impl Iterator<Item = Result<Judgement, PersonalizeError>>,
) -> Result<Judgement, PersonalizeError> {
    let first = parts.next().ok_or(StepError::NoRecordings)??;
    parts.try_fold(first, |sum, part| Ok(sum.and(part?)))
}

#[cfg(test)]
mod tests;
