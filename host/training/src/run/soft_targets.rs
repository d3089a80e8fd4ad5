//! Soft targets: the logits of the teacher over the training streams, computed once and kept in the run folder.

use shared::model::LookBackLogits;
use shared::units::{CleanSample, PATCH};

use super::context::RunContext;
use super::error::StepError;
use execution::fingerprint::Fingerprint;
use execution::progress;
use execution::run_folder::Artefact;

const FILE: &str = "soft-targets.bin";
const LOGITS: &str = "logits";

/// Returns the teacher's logits at every patch of the training streams, computed or kept.
pub(super) fn soft_targets(
    context: &RunContext,
    streams: &[&[CleanSample]],
) -> Result<Vec<Vec<LookBackLogits>>, StepError> {
    let (folder, config) = (&context.folder, &context.config);
    // The streams are part of the teacher's lineage.
    let made_from = Fingerprint::of(&(config.teacher_lineage(), config.teaching_weights(folder)?));
    let path = folder.file(FILE);
    // Targets of another teacher are ignored and computed again.
    if let Ok(mut kept) = folder.load_artefact(&path)
        && kept.made_from == made_from
        && let Ok(bytes) = kept.take(LOGITS)
        && let Some(targets) = unpack(&bytes, streams)
    {
        return Ok(targets);
    }
    let logits = context.logits(presets::teacher::NAME)?;
    let targets = progress::map(
        "soft targets",
        streams,
        &context.folder,
        &context.interrupt,
        |emg| logits(emg),
    )?;
    Artefact::new(path, made_from, &())?
        .with(LOGITS, pack(&targets))
        .save()?;
    Ok(targets)
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
