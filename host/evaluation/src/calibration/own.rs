//! A model file calibrated on one person's recordings.

use recordings::Library;
use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::lags;
use recordings::split::predefined;
use shared::calibration::Shown;
use shared::model::file::Model;
use shared::units::Sample;

use super::{Calibration, calibrate, parts, rounds_of};
use crate::model_evaluation::{Lesson, evaluated_recordings, labelled};
use crate::{EvaluatedRecording, EvaluationError};

/// Fewest rounds: one teaches, one judges.
pub const FEWEST_ROUNDS: usize = 2;

/// Result of a calibration on a person's own recordings.
#[derive(Clone, Debug)]
pub struct OwnCalibration {
    /// The person, as `data-set/subject`.
    pub subject: String,
    /// Rounds in the recordings.
    pub rounds: usize,
    /// Whether other movement was shown.
    pub others: bool,
    /// Mean recall of the classes in the later half of the rounds: of the old head, and of one learnt from the earlier half.
    pub recalls: [f32; 2],
    /// Model file with the new head, which has seen the person; `None` if the old head is kept.
    pub file: Option<Vec<u8>>,
}

/// Calibrates a model file on all rounds of a person (`data-set/subject`, or the part after the slash), or of the only
/// person; with `others` on other movement too, if the recordings and the model have it. The first opening aligns the armband,
/// as on a board; the file is for an armband that sits as in the recordings.
///
/// # Errors
/// When the model is refused, it is unclear whose recordings are meant, or they hold too few rounds.
pub fn calibrate_file(
    file: &[u8],
    library: &Library,
    subject: Option<&str>,
    others: bool,
) -> Result<OwnCalibration, EvaluationError> {
    let model = Model::parse(file)?;
    let dimensions = &model.header.dimensions;
    let [subject] = &library.named(subject)[..] else {
        return Err(EvaluationError::Whose(library.subjects()));
    };
    let labelled = labelled(library, dimensions.vocabulary);
    let lags = lags(&labelled, LabelLag::default(), &predefined::is_training);
    let recordings = evaluated_recordings(&labelled, dimensions.vocabulary, &lags, |recording| {
        (recording.subject == *subject).then_some(|_: &mut Vec<Sample>| ())
    });
    calibrate_on(file, subject, &recordings, others, true)
}

/// Calibrates a model file as [`calibrate_file`], on recordings of this person; aligned by the first opening if wanted.
///
/// # Errors
/// When the model is refused, or the recordings hold too few rounds.
pub fn calibrate_on(
    file: &[u8],
    subject: &str,
    recordings: &[EvaluatedRecording],
    others: bool,
    align: bool,
) -> Result<OwnCalibration, EvaluationError> {
    let model = Model::parse(file)?;
    let dimensions = &model.header.dimensions;
    let recordings: Vec<&EvaluatedRecording> = recordings.iter().collect();
    let rounds = rounds_of(&recordings, dimensions.vocabulary);
    if rounds < FEWEST_ROUNDS {
        return Err(EvaluationError::FewRounds(rounds));
    }
    let parts = parts(&recordings, dimensions.vocabulary, rounds);
    let others = others && dimensions.other && parts.iter().any(|part| part.shown == Shown::Other);
    let lesson = Lesson {
        rounds,
        others,
        align,
    };
    let Calibration {
        head,
        judged,
        refusal,
        alignment,
    } = calibrate(&model, &recordings, &parts, lesson)?;
    if let Some(refusal) = refusal {
        return Err(EvaluationError::NotCalibrated {
            subject: subject.to_owned(),
            refusal,
        });
    }
    let file = match &head {
        Some(head) => {
            let calibrated = Model::with_head(file, head)?;
            let mut parts = Model::parse(&calibrated)?.to_parts();
            parts.align(alignment);
            let seen = &mut parts.provenance.subjects_seen;
            if !seen.iter().any(|own| own == subject) {
                seen.push(subject.to_owned());
            }
            Some(parts.to_bytes()?)
        }
        None => None,
    };
    Ok(OwnCalibration {
        subject: subject.to_owned(),
        rounds,
        others,
        recalls: judged.unwrap_or_default(),
        file,
    })
}
