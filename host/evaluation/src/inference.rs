//! Inference over whole recordings, as a device does it: the logits of a model file at every patch, and a stream through
//! the device's own pipeline, sample by sample.
//!
//! Logits have one form for teacher, float student and integer student: after each patch, those of
//! that patch and of the five before it ([`LookBackLogits`], newest
//! first, unused classes 0). The code that smooths and scores them is the same for all models.

mod stream;

use recordings::corpus::padded;
use shared::model::encoder::HostEncoder;
use shared::model::file::{Model, ModelError};
use shared::model::head::Head;
use shared::model::{Encode, LookBackLogits};
use shared::stream::normalizer::Normalizer;
use shared::stream::preprocess::{Preprocessing, clean};
use shared::units::{CleanSample, PATCH, Patch, Sample, WINDOW_PATCHES};

pub use self::stream::Stream;

/// Input of a model from the samples of a stream, from its beginning: preprocessed as in training, and as a board does
/// it.
pub fn input(samples: &[Sample], preprocessing: Preprocessing) -> Vec<CleanSample> {
    let mut wearer = preprocessing.normalized.then(Normalizer::default);
    let samples = samples.iter().map(|&sample| match &mut wearer {
        Some(wearer) => wearer.push(sample),
        None => sample,
    });
    clean(samples, preprocessing.median).collect()
}

/// Logits after each of the patches of a stream, from its beginning.
pub fn outputs(model: &Model<'_>, patches: &[Patch]) -> Result<Vec<LookBackLogits>, ModelError> {
    Ok(outputs_of(&HostEncoder::new(model)?, patches))
}

fn outputs_of(encoder: &HostEncoder<'_>, patches: &[Patch]) -> Vec<LookBackLogits> {
    let mut outputs = Vec::with_capacity(patches.len());
    let mut state = encoder.fresh();
    encoder.steps(&mut state, patches, |logits| outputs.push(logits));
    outputs
}

/// Logits of an integer student at every whole patch of a recording, as the device computes them, after a
/// lead-in of one window.
pub fn integer_logits(
    model: &Model<'_>,
    emg: &[CleanSample],
) -> Result<Vec<LookBackLogits>, ModelError> {
    logits_with(model, None, emg)
}

/// Logits like [`integer_logits`], with a head in place of the model's own.
pub fn logits_with(
    model: &Model<'_>,
    head: Option<&Head>,
    emg: &[CleanSample],
) -> Result<Vec<LookBackLogits>, ModelError> {
    let mut encoder = HostEncoder::new(model)?;
    if let Some(head) = head {
        encoder = encoder.with_head(head);
    }
    let stream = padded(emg);
    let (patches, _) = stream.as_chunks::<PATCH>();
    Ok(outputs_of(&encoder, patches).split_off(WINDOW_PATCHES))
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use super::*;
    use shared::intent::Vocabulary;
    use shared::model::dimensions::Dimensions;
    use shared::model::encoder::DeviceEncoder;
    use shared::model::file::random::random_model;

    #[test]
    fn the_outputs_are_those_of_the_device_step_by_step() {
        let dimensions = Dimensions::new(Vocabulary::Six, 64, 2, 27);
        let bytes = random_model(dimensions, 5).to_bytes().unwrap();
        let model = Model::parse(&bytes).unwrap();
        let device = DeviceEncoder::new(&model).unwrap();
        let sample = |at: usize| from_fn(|channel| ((at * 8 + channel) * 37 % 129) as u8);
        let patches: Vec<Patch> = (0..39)
            .map(|step| from_fn(|at| sample(10 * step + at)))
            .collect();
        let mut state = device.fresh();
        let expected = patches.iter().map(|patch| device.step(&mut state, patch));
        let expected: Vec<LookBackLogits> = expected.collect();
        for count in [0, 1, 3, 4, 38, 39] {
            let found = outputs(&model, &patches[..count]).unwrap();
            assert_eq!(found, expected[..count]);
        }
    }
}
