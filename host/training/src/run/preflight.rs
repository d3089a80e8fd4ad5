//! Checks before hours of training.

use crate::student::model::Student;
use burn::tensor::Device;
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, ProvenanceParts};
use shared::stream::smoother::AggregationMode;

use super::error::StepError;
use crate::student::quantization;
use presets::Preset;

/// Refuses a student that cannot become a model file, or that no board can run. A student with random weights is written,
/// read and loaded by the code that will do so with the trained one.
///
/// # Errors
/// [`StepError::Student`], [`StepError::Board`].
pub(super) fn refuse_impossible(preset: &Preset, device: &Device) -> Result<(), StepError> {
    let student = Student::new(&preset.student, preset.classes, preset.other(), device);
    let smoother = preset.smoother_defaults(AggregationMode::AllRowsFrom);
    let provenance = ProvenanceParts::default();
    let (config, vocabulary) = (&preset.student, preset.vocabulary());
    let bytes = quantization::quantize(
        &student,
        config,
        vocabulary,
        (smoother, preset.preprocessing()),
        None,
        provenance,
    )
    .map_err(StepError::Student)?;
    let model = Model::parse(&bytes).map_err(StepError::Student)?;
    if preset.student.board {
        DeviceEncoder::new(&model).map_err(StepError::Board)?;
    }
    Ok(())
}
