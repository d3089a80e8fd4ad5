//! Inference of the integer student: the device's encoder on the host.

use shared::model::encoder::HostEncoder;
use shared::model::file::{Model, ModelError};
use shared::model::{Encode, LookBackLogits};
use shared::units::{CleanSample, PATCH, Patch, WINDOW_PATCHES};

use recordings::corpus::padded;

/// Logits after each of the patches of a stream, from its beginning.
///
/// # Errors
/// If the encoder refuses the model.
pub fn outputs(model: &Model<'_>, patches: &[Patch]) -> Result<Vec<LookBackLogits>, ModelError> {
    let encoder = HostEncoder::new(model)?;
    let mut outputs = Vec::with_capacity(patches.len());
    let mut state = encoder.fresh();
    encoder.steps(&mut state, patches, |logits| outputs.push(logits));
    Ok(outputs)
}

/// Logits of an integer student at every whole patch of a recording, as the device computes them, after a
/// lead-in of one window.
///
/// # Errors
/// When the encoder refuses the model.
pub fn integer_logits(
    model: &Model<'_>,
    emg: &[CleanSample],
) -> Result<Vec<LookBackLogits>, ModelError> {
    let stream = padded(emg);
    let (patches, _) = stream.as_chunks::<PATCH>();
    Ok(outputs(model, patches)?
        .into_iter()
        .skip(WINDOW_PATCHES)
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::intent::Vocabulary;
    use shared::model::dimensions::{Dimensions, usual_span};
    use shared::model::encoder::DeviceEncoder;
    use shared::model::file::random::random_model;

    fn model_bytes(width: usize, layers: usize, span: usize) -> Vec<u8> {
        let vocabulary = Vocabulary::Six;
        let dimensions = Dimensions {
            width,
            layers,
            span,
            vocabulary,
            other: false,
        };
        random_model(dimensions, 5).to_bytes().unwrap()
    }

    #[test]
    fn the_outputs_are_those_of_the_device_step_by_step() {
        let bytes = model_bytes(64, 2, usual_span(2));
        let model = Model::parse(&bytes).unwrap();
        let device = DeviceEncoder::new(&model).unwrap();
        let patches: Vec<Patch> = (0..39)
            .map(|step| {
                let mut patch = Patch::default();
                for (index, value) in patch.as_flattened_mut().iter_mut().enumerate() {
                    *value = ((index * 37 + step * 11) % 129) as u8;
                }
                patch
            })
            .collect();
        let mut state = device.fresh();
        let expected: Vec<LookBackLogits> = patches
            .iter()
            .map(|patch| device.step(&mut state, patch))
            .collect();
        for count in [0, 1, 3, 4, 38, 39] {
            assert_eq!(
                outputs(&model, &patches[..count]).unwrap(),
                expected[..count]
            );
        }
    }
}
