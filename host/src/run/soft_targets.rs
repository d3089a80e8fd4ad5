//! Soft targets: the logits of the teacher, or of an ensemble of students, over the training streams, computed once and
//! kept in the run folder.

use shared::model::LookBackLogits;
use shared::units::{CleanSample, PATCH};

use super::context::RunContext;
use super::error::StepError;
use crate::execution::fingerprint::Fingerprint;
use crate::execution::parallel;
use crate::execution::run_folder::{Artefact, RunError};
use crate::inference::{student_logits, teacher_logits};

const FILE: &str = "soft-targets.bin";
const LOGITS: &str = "logits";

/// The logits of the teacher, or of the ensemble, at every patch of the training streams.
///
/// # Errors
/// When there is none, the folder cannot be written or the user interrupts.
pub(super) fn soft_targets(
    context: &RunContext,
    streams: &[&[CleanSample]],
) -> Result<Vec<Vec<LookBackLogits>>, StepError> {
    let (folder, config) = (&context.folder, &context.config);
    // The teacher's lineage has the streams in it.
    let made_from = Fingerprint::of(&(config.teacher_lineage(), config.teaching_weights(folder)?));
    let path = folder.file(FILE);
    // Targets of another teacher are no mistake: they are computed again.
    if let Ok(mut kept) = folder.load_artefact(&path)
        && kept.made_from == made_from
        && let Ok(bytes) = kept.take(LOGITS)
        && let Some(targets) = unpack(&bytes, streams)
    {
        return Ok(targets);
    }
    let members = config.preset.distillation.members();
    let targets = if members.is_empty() {
        of_teacher(context, streams)?
    } else {
        of_ensemble(context, members, streams)?
    };
    let artefact = Artefact::new(made_from, &())
        .map_err(|error| RunError::content(&path, error))?
        .with(LOGITS, pack(&targets));
    folder.save_artefact(&path, &artefact)?;
    Ok(targets)
}

/// The teacher's logits.
fn of_teacher(
    context: &RunContext,
    streams: &[&[CleanSample]],
) -> Result<Vec<Vec<LookBackLogits>>, StepError> {
    let model = context.teacher()?;
    let device = context.inference_device();
    let shape = context.config.preset.teacher.window_shape();
    Ok(parallel::map(
        "soft targets",
        streams,
        &context.folder,
        &context.interrupt,
        |emg| teacher_logits(&model, shape, emg, &device),
    )?)
}

/// Logarithms of the mean of the members' probabilities.
fn of_ensemble(
    context: &RunContext,
    members: &[&str],
    streams: &[&[CleanSample]],
) -> Result<Vec<Vec<LookBackLogits>>, StepError> {
    let device = context.inference_device();
    let classes = context.config.preset.classes;
    let students = members
        .iter()
        .map(|member| context.student(member))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(parallel::map(
        "soft targets",
        streams,
        &context.folder,
        &context.interrupt,
        |emg| {
            let each = students.iter();
            let each: Vec<_> = each
                .map(|student| student_logits(student, emg, &device))
                .collect();
            (0..emg.len() / PATCH)
                .map(|patch| {
                    let own: Vec<&LookBackLogits> = each.iter().map(|all| &all[patch]).collect();
                    mean(&own, classes)
                })
                .collect()
        },
    )?)
}

/// Logarithm of the mean probability of each class, row by row; 0 for unused classes.
fn mean(members: &[&LookBackLogits], classes: usize) -> LookBackLogits {
    let mut rows = LookBackLogits::default();
    for (back, row) in rows.iter_mut().enumerate() {
        for logits in members.iter().map(|member| &member[back][..classes]) {
            let largest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let total: f32 = logits.iter().map(|logit| (logit - largest).exp()).sum();
            for (sum, logit) in row.iter_mut().zip(logits) {
                *sum += (logit - largest).exp() / (total * members.len() as f32);
            }
        }
        for probability in &mut row[..classes] {
            *probability = probability.max(f32::MIN_POSITIVE).ln();
        }
    }
    rows
}

fn pack(targets: &[Vec<LookBackLogits>]) -> Vec<u8> {
    let values = targets.iter().flatten().flatten().flatten();
    values.flat_map(|value| value.to_le_bytes()).collect()
}

fn unpack(bytes: &[u8], streams: &[&[CleanSample]]) -> Option<Vec<Vec<LookBackLogits>>> {
    let patches: usize = streams.iter().map(|emg| emg.len() / PATCH).sum();
    if bytes.len() != patches * size_of::<LookBackLogits>() {
        return None;
    }
    let (values, _) = bytes.as_chunks::<4>();
    let mut values = values.iter().map(|&value| f32::from_le_bytes(value));
    let mut next =
        || std::array::from_fn(|_| std::array::from_fn(|_| values.next().unwrap_or(0.0)));
    Some(
        streams
            .iter()
            .map(|emg| (0..emg.len() / PATCH).map(|_| next()).collect())
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ensemble_is_the_mean_of_probabilities() {
        let logits = |probabilities: [f32; 3]| {
            let mut rows = LookBackLogits::default();
            for (back, row) in rows.iter_mut().enumerate() {
                // A constant added to all logits changes no probability.
                for (to, probability) in row.iter_mut().zip(probabilities) {
                    *to = probability.ln() + 30.0 * back as f32;
                }
            }
            rows
        };
        let members = [logits([0.8, 0.1, 0.1]), logits([0.2, 0.3, 0.5])];
        let found = mean(&members.each_ref(), 3);
        for row in found {
            for (logit, expected) in row.iter().zip([0.5, 0.2, 0.3]) {
                assert!((logit.exp() - expected).abs() < 1e-5, "{row:?}");
            }
            assert_eq!(row[3..], [0.0; 4]);
        }
        // A class that no member believes in has no infinite logit.
        let mut sure = LookBackLogits::default();
        sure[0][0] = 1000.0;
        assert!(
            mean(&[&sure], 3)
                .iter()
                .flatten()
                .all(|logit| logit.is_finite())
        );
    }

    #[test]
    fn kept_targets_are_used_for_the_same_streams_alone() {
        let stream = [[0; 8]; 25];
        let mut targets = vec![vec![LookBackLogits::default(); 2]];
        targets[0][1][5][2] = 1.5;
        let bytes = pack(&targets);
        assert_eq!(unpack(&bytes, &[&stream]), Some(targets));
        assert_eq!(unpack(&bytes, &[&stream[..9]]), None);
        assert_eq!(unpack(&bytes[..bytes.len() - 1], &[&stream]), None);
    }
}
