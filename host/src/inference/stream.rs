//! A stream through the device's own pipeline, sample by sample, as the device runs it.

use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::Pipeline;
use shared::stream::safe_state::Start;
use shared::stream::smoother::SettingsError;

/// The pipeline of a model as a board sets it up at its start; `encoder` is that of the model.
///
/// # Errors
/// When the smoother refuses the settings of the model.
pub(crate) fn pipeline<'s, E: Encode>(
    model: &Model<'_>,
    encoder: E,
    state: &'s mut E::State,
) -> Result<Pipeline<'s, E>, SettingsError> {
    let settings = model.header.smoother.in_patches();
    let mut pipeline = Pipeline::new(encoder, state, settings, Start::Boot)?;
    pipeline.preprocess(model.header.preprocessing);
    pipeline.set_template(model.header.template);
    Ok(pipeline)
}
