//! A model file fine-tuned on one person's own recordings.
//!
//! The recordings are divided: a part is tuned on, a part is held back, on which the old and the new integer model are
//! judged as `evaluate --model` judges. Measured in docs/personalization.md.

mod error;
mod judgement;
mod part;
mod person;
mod tuning;

use burn::tensor::Device;
use shared::model::file::Model;

pub use self::error::PersonalizeError;
pub use self::judgement::{judge, judge_constant, not_worse};
pub use self::part::Part;
pub use self::person::Person;
pub use self::tuning::{TuningSettings, tune};
use crate::dataset::Library;
use crate::evaluation::Score;
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;

/// What came of it.
#[derive(Clone, Debug)]
pub struct Personalized {
    /// The new model file.
    pub bytes: Vec<u8>,
    /// The person, as `data-set/subject`.
    pub subject: String,
    /// Whether the old model was trained on this person already or validated with: its scores are too good.
    pub seen_before: bool,
    /// Seconds that were tuned on.
    pub tuned_seconds: f64,
    /// Seconds that were held back.
    pub judged_seconds: f64,
    /// Scores on the part held back: the old model, the new one, and always relax.
    pub scores: [Score; 3],
}

impl Personalized {
    /// Whether the new model is not worse than the old one ([`not_worse`]).
    #[must_use]
    pub fn is_not_worse(&self) -> bool {
        let [old, new, _] = &self.scores;
        not_worse(old, new)
    }
}

/// Fine-tunes a model file on the recordings of a person, and judges it on the part of them that is held back.
///
/// Without a name the recordings have to be one person's. `report` is told after each step how many of
/// [`TuningSettings::steps`] are taken.
///
/// # Errors
/// When the model is refused, the recordings do not allow it, the training diverges or the user interrupts.
pub fn personalize(
    file: &[u8],
    library: &Library,
    subject: Option<&str>,
    settings: &TuningSettings,
    device: &Device,
    interrupt: &Interrupt,
    report: impl FnMut(usize),
) -> Result<Personalized, PersonalizeError> {
    let model = Model::parse(file)?;
    let person = Person::new(library, subject, &model.header)?;
    if !person.outside().is_empty() {
        progress::log(&format!(
            "gestures that the model does not have, counted as none: {}",
            person.outside().join(", ")
        ));
    }
    progress::log(&format!("labels: {}", person.lag()));
    let (tuned, judged) = person.whole().divided()?;
    progress::log(&format!(
        "{}: {:.0} s to tune on, {:.0} s held back",
        person.subject(),
        tuned.seconds(),
        judged.seconds()
    ));
    let bytes = tune(file, &tuned, settings, device, interrupt, report)?;
    let scores = [
        judge("before", file, &judged)?,
        judge("after", &bytes, &judged)?,
        judge_constant(&judged, model.header.dimensions.vocabulary)?,
    ];
    let mut seen = model.header.provenance.subjects_seen.iter();
    Ok(Personalized {
        subject: person.subject().to_owned(),
        seen_before: seen.any(|seen| seen == person.subject()),
        tuned_seconds: tuned.seconds(),
        judged_seconds: judged.seconds(),
        bytes,
        scores,
    })
}

#[cfg(test)]
mod tests;
