//! Training of a job, and its logits over the recordings.

use evaluation::model_evaluation::{NamedModel, beside};
use evaluation::{Candidate, EvaluatedRecording, constant};
use training::run::context::RunContext;
use training::run::evaluate::energy_detector;
use training::run::quantize::{MODEL, quantize};
use training::run::train::train;

use super::contender::ContenderKind;
use super::job::{CrossValidation, Job};
use crate::baselines::BaselineSettings;
use crate::baselines::inference::candidate;
use crate::baselines::training::train_baseline;
use crate::job::JobError;

impl CrossValidation<'_> {
    /// Trains the job's models, or those still missing. Returns the logits over the recordings, which are made after the
    /// training.
    pub(super) fn trained(
        &self,
        job: &Job,
        context: &RunContext,
        recordings: &dyn Fn() -> Vec<EvaluatedRecording>,
    ) -> Result<(Candidate, Vec<EvaluatedRecording>), JobError> {
        match job.contender.kind {
            ContenderKind::Student => {
                train(context, false)?;
                let model = NamedModel {
                    name: job.contender.name().to_owned(),
                    bytes: quantize(context, &context.folder.file(MODEL))?,
                };
                let recordings = recordings();
                Ok((
                    beside(&model, &recordings).map_err(training::run::StepError::from)?,
                    recordings,
                ))
            }
            ContenderKind::Baseline(baseline) => {
                train_baseline(context, baseline, &BaselineSettings::default())?;
                let recordings = recordings();
                Ok((candidate(context, baseline, &recordings)?, recordings))
            }
            ContenderKind::Constant => {
                let recordings = recordings();
                Ok((constant(&recordings), recordings))
            }
            ContenderKind::EnergyDetector => {
                let detector = energy_detector(&context.config, &self.library);
                let recordings = recordings();
                // Without a gesture to fit the detector to, its label is always relax.
                let floor = detector.map_or_else(
                    || constant(&recordings),
                    |detector| detector.candidate(&recordings),
                );
                Ok((floor, recordings))
            }
        }
    }
}
