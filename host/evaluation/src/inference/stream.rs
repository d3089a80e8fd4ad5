//! A stream through the device's own pipeline, sample by sample, as the device runs it.

use std::ops::ControlFlow;

use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::Pipeline;
use shared::stream::safe_state::Start;
use shared::stream::smoother::SettingsError;
use shared::uart_line::line::Line;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};

/// Samples of a notification of the armband.
const TOGETHER: usize = 2;

/// The pipeline of a model as a board sets it up at its start; `encoder` is that of the model.
///
/// # Errors
/// When the smoother refuses the settings of the model.
pub fn pipeline<'s, E: Encode>(
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

/// Passes a recording through a pipeline as an armband sends it, two samples every 10 ms. `wait` is called with the
/// time before each two. `output` is called with each line that a board writes, a report or a change of the alignment,
/// until it breaks off.
pub fn feed<E: Encode, B>(
    pipeline: &mut Pipeline<'_, E>,
    samples: &[Sample],
    mut wait: impl FnMut(Millis),
    mut output: impl FnMut(Line<'_>) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let mut now = Millis(0);
    for pair in samples.chunks(TOGETHER) {
        wait(now);
        for &sample in pair {
            for report in pipeline.sample(now, sample) {
                output(Line::Report(report))?;
            }
            if let Some(report) = pipeline.take_alignment_report() {
                output(Line::Alignment(report))?;
            }
        }
        now = now.plus(TOGETHER as u32 * SAMPLE_PERIOD_MS);
    }
    ControlFlow::Continue(())
}
