//! Candidates of an evaluation: the float models of a run, and their logits over recordings.

use shared::stream::alignment::Alignment;
use shared::stream::smoother::AggregationMode;

use super::context::RunContext;
use evaluation::{Candidate, EvaluatedRecording, System};
use execution::progress;
use execution::run_folder::RunError;

/// Computes the logits of a float model, by the name of its files, over all recordings, on all cores; `system` names it in tables.
pub(super) fn candidate(
    context: &RunContext,
    model: &str,
    system: System,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, RunError> {
    let preset = &context.config.preset;
    let logits = context.logits(model)?;
    let logits = progress::map(
        &system.name(),
        recordings,
        &context.folder,
        &context.interrupt,
        |recording| logits(&recording.input(preset.preprocessing(), Alignment::NONE)),
    )?;
    // The aggregation mode is a condition of the evaluation.
    let smoother = preset.smoother_defaults(AggregationMode::AllRowsFrom);
    Ok(Candidate::new(system, logits, &smoother))
}
