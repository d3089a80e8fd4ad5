//! Soft targets: the teacher's logits over the training streams, computed once and kept in the run folder.

use shared::model::LookBackLogits;
use shared::units::{CleanSample, PATCH};

use super::context::RunContext;
use super::error::StepError;
use crate::execution::parallel;
use crate::execution::run_folder::write_whole;
use crate::inference::teacher_logits;
use crate::teacher;

const FILE: &str = "soft-targets.bin";

/// The teacher's logits at every patch of the training streams.
///
/// # Errors
/// When there is no teacher, the folder cannot be written or the user interrupts.
pub(super) fn soft_targets(
    context: &RunContext,
    streams: &[&[CleanSample]],
) -> Result<Vec<Vec<LookBackLogits>>, StepError> {
    let checkpoint = context.folder.weights_path(teacher::training::NAME);
    let weights = std::fs::read(&checkpoint).map_err(|source| StepError::NoTeacher {
        path: checkpoint,
        source,
    })?;
    let key = crc32(&weights);
    let path = context.folder.file(FILE);
    if let Some(targets) = std::fs::read(&path)
        .ok()
        .and_then(|bytes| unpack(&bytes, key, streams))
    {
        return Ok(targets);
    }
    let model = context.teacher()?;
    let device = context.inference_device();
    let shape = context.config.preset.teacher.window_shape();
    let targets = parallel::map(
        "soft targets",
        streams,
        &context.folder,
        &context.interrupt,
        |emg| teacher_logits(&model, shape, emg, &device),
    )?;
    write_whole(&path, &pack(&targets, key))?;
    Ok(targets)
}

fn crc32(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

fn pack(targets: &[Vec<LookBackLogits>], key: u32) -> Vec<u8> {
    let mut bytes = key.to_le_bytes().to_vec();
    for value in targets.iter().flatten().flatten().flatten() {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

fn unpack(bytes: &[u8], key: u32, streams: &[&[CleanSample]]) -> Option<Vec<Vec<LookBackLogits>>> {
    let (found, bytes) = bytes.split_first_chunk::<4>()?;
    let patches: usize = streams.iter().map(|emg| emg.len() / PATCH).sum();
    if u32::from_le_bytes(*found) != key || bytes.len() != patches * size_of::<LookBackLogits>() {
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
    fn kept_targets_are_used_for_the_same_weights_and_streams_alone() {
        let stream = [[0; 8]; 25];
        let mut targets = vec![vec![LookBackLogits::default(); 2]];
        targets[0][1][5][2] = 1.5;
        let bytes = pack(&targets, 7);
        assert_eq!(unpack(&bytes, 7, &[&stream]), Some(targets));
        assert_eq!(unpack(&bytes, 8, &[&stream]), None);
        assert_eq!(unpack(&bytes, 7, &[&stream[..9]]), None);
        assert_eq!(unpack(&bytes[..bytes.len() - 1], 7, &[&stream]), None);
    }
}
